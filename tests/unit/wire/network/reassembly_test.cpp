#include "server/wire/network/reassembly.hpp"

#include <gtest/gtest.h>

#include <map>
#include <numeric>

#include "tests/support/lcm_datagrams.hpp"

namespace isthmus {
namespace {

constexpr LcmSender robots_sender{0x0a000001, 40'000};

Bytes counted(std::size_t size) {
  Bytes bytes(size);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{1});
  return bytes;
}

/// A reassembly that takes channels beginning with R, and what came out of it.
struct HeardReassembly {
  std::vector<std::pair<std::string, Bytes>> messages;
  std::map<std::string, int> drops;  ///< by reason, with the channel: "R1_SCAN fragments_lost"
  std::int64_t now_us = 0;
  Reassembly reassembly;

  explicit HeardReassembly(ReassemblyLimits limits = {})
      : reassembly({[](std::string_view channel) { return channel.starts_with("R"); },
                    [this](std::int64_t, std::string_view channel, std::span<const std::uint8_t> bytes) {
                      messages.emplace_back(channel, Bytes(bytes.begin(), bytes.end()));
                    },
                    [this](std::string_view channel, DropReason reason) {
                      drops[std::string(channel) + " " + std::string(word(reason))] += 1;
                    }},
                   limits) {}

  void take(const Bytes& datagram, LcmSender sender = robots_sender) {
    reassembly.take(sender, datagram, 1'700'000'000'000'000, now_us);
  }
  void take_all(const std::vector<Bytes>& datagrams, LcmSender sender = robots_sender) {
    for (const Bytes& datagram : datagrams) take(datagram, sender);
  }
};

TEST(Reassembly, HandsOnShortMessagesOfWantedChannels) {
  HeardReassembly heard;
  heard.take(short_datagram(1, "R1_SCAN", counted(5)));
  heard.take(short_datagram(2, "CAMERA", counted(5)));
  ASSERT_EQ(heard.messages.size(), 1U);
  EXPECT_EQ(heard.messages[0], (std::pair{std::string("R1_SCAN"), counted(5)}));
  EXPECT_TRUE(heard.drops.empty()) << "a channel that nobody wants is no drop";
}

TEST(Reassembly, MakesOneMessageOfFragmentsInAnyOrder) {
  const Bytes message = counted(1000);
  std::vector<Bytes> datagrams = fragment_datagrams(1, "R1_SCAN", message, 300);
  ASSERT_EQ(datagrams.size(), 4U);
  std::sort(datagrams.begin(), datagrams.end());
  do {
    HeardReassembly heard;
    heard.take_all(datagrams);
    ASSERT_EQ(heard.messages.size(), 1U);
    EXPECT_EQ(heard.messages[0].second, message);
    EXPECT_EQ(heard.reassembly.bytes(), 0U);
  } while (std::next_permutation(datagrams.begin(), datagrams.end()));
}

TEST(Reassembly, TellsWhenTheLastDatagramCame) {
  std::int64_t received = 0;
  Reassembly reassembly({[](auto) { return true; }, [&](std::int64_t utime, auto, auto) { received = utime; },
                         [](auto, auto) {}});
  std::int64_t utime = 100;
  for (const Bytes& datagram : fragment_datagrams(1, "R1_SCAN", counted(500), 300))
    reassembly.take(robots_sender, datagram, utime++, 0);
  EXPECT_EQ(received, 101);
}

TEST(Reassembly, HandsOnAMessageOnceThoughTheNetworkDoublesIt) {
  HeardReassembly heard;
  const auto datagrams = fragment_datagrams(1, "R1_SCAN", counted(1000), 300);
  for (const Bytes& datagram : datagrams) heard.take_all({datagram, datagram});
  heard.take_all(datagrams);
  EXPECT_EQ(heard.messages.size(), 1U);
  EXPECT_TRUE(heard.drops.empty());
}

TEST(Reassembly, KeepsSendersApart) {
  HeardReassembly heard;
  const LcmSender other{robots_sender.address, 40'001};
  const auto one = fragment_datagrams(1, "R1_SCAN", Bytes(1000, 1), 300);
  const auto two = fragment_datagrams(1, "R2_SCAN", Bytes(1000, 2), 300);
  for (std::size_t i = 0; i < one.size(); ++i) {
    heard.take(one[i], robots_sender);
    heard.take(two[i], other);
  }
  ASSERT_EQ(heard.messages.size(), 2U);
  EXPECT_EQ(heard.messages[0], (std::pair{std::string("R1_SCAN"), Bytes(1000, 1)}));
  EXPECT_EQ(heard.messages[1], (std::pair{std::string("R2_SCAN"), Bytes(1000, 2)}));
}

TEST(Reassembly, CountsDatagramsThatAreNone) {
  HeardReassembly heard;
  heard.take(Bytes{1, 2, 3});
  heard.take_all(wrapped_offset_attack("R1_SCAN"));
  EXPECT_EQ(heard.drops, (std::map<std::string, int>{{" malformed_packet", 2}}));
}

// Fragments that are each right and do not fit together: a gap, an overlap, the same number twice.
TEST(Reassembly, RefusesFragmentsThatContradictOneAnother) {
  const TestFragment first{1, 300, 0, 0, 3, "R1_SCAN", Bytes(100)};
  const TestFragment gap{1, 300, 150, 1, 3, "", Bytes(50)};
  const TestFragment overlap{1, 300, 50, 1, 3, "", Bytes(100)};
  const TestFragment last{1, 300, 200, 2, 3, "", Bytes(100)};
  const TestFragment short_last{1, 300, 100, 1, 2, "", Bytes(50)};
  TestFragment first_of_two = first;
  first_of_two.fragments = 2;
  TestFragment other_last = last;
  other_last.data = Bytes(100, 1);
  for (const auto& fragments :
       {std::vector{first, gap, last}, std::vector{first, overlap, last},
        std::vector{first_of_two, short_last}, std::vector{first, last, other_last}}) {
    HeardReassembly heard;
    for (const TestFragment& fragment : fragments) heard.take(fragment_datagram(fragment));
    EXPECT_TRUE(heard.messages.empty());
    EXPECT_EQ(heard.drops, (std::map<std::string, int>{{"R1_SCAN malformed_packet", 1}}));
    EXPECT_EQ(heard.reassembly.bytes(), 0U);
  }
}

TEST(Reassembly, BeginsAnewWhereASenderCountsAnew) {
  HeardReassembly heard;
  heard.take(fragment_datagrams(1, "R1_SCAN", counted(1000), 300)[0]);
  heard.take_all(fragment_datagrams(1, "R1_SCAN", counted(900), 300));
  ASSERT_EQ(heard.messages.size(), 1U);
  EXPECT_EQ(heard.messages[0].second, counted(900));
  EXPECT_EQ(heard.drops, (std::map<std::string, int>{{"R1_SCAN fragments_lost", 1}}));
}

TEST(Reassembly, RefusesMessagesThatAreTooLargeAndCountsEachOnce) {
  ReassemblyLimits limits;
  limits.message_bytes = 1000;
  limits.fragments = 10;
  HeardReassembly heard(limits);
  heard.take_all(fragment_datagrams(1, "R1_SCAN", counted(1001), 300));
  heard.take_all(fragment_datagrams(2, "R1_SCAN", counted(1000), 90));
  heard.take_all(fragment_datagrams(3, "CAMERA", counted(100'000), 1000));
  EXPECT_TRUE(heard.messages.empty());
  EXPECT_EQ(heard.reassembly.messages(), 0U);
  EXPECT_EQ(heard.drops, (std::map<std::string, int>{{"R1_SCAN message_too_large", 1},
                                                     {"R1_SCAN too_many_fragments", 1}}));
  heard.take_all(fragment_datagrams(4, "R1_SCAN", counted(1000), 300));
  EXPECT_EQ(heard.messages.size(), 1U);
}

TEST(Reassembly, HoldsNothingOfChannelsThatNobodyWants) {
  HeardReassembly heard;
  const auto datagrams = fragment_datagrams(1, "CAMERA", counted(1'000'000), 60'000);
  for (const Bytes& datagram : datagrams) {
    heard.take(datagram);
    EXPECT_EQ(heard.reassembly.bytes(), 0U);
  }
  EXPECT_TRUE(heard.drops.empty());
}

TEST(Reassembly, GivesUpAnUnfinishedMessageAfterItsTime) {
  HeardReassembly heard;
  const auto datagrams = fragment_datagrams(1, "R1_SCAN", counted(1000), 300);
  heard.take_all({datagrams[0], datagrams[1]});
  EXPECT_GT(heard.reassembly.bytes(), 600U - 20U);
  heard.now_us = 1'000'000;
  heard.take(datagrams[2]);
  heard.now_us = 2'000'001;
  heard.take(short_datagram(2, "R1_ODOMETRY", counted(5)));
  EXPECT_EQ(heard.drops, (std::map<std::string, int>{{"R1_SCAN fragments_lost", 1}}));
  EXPECT_EQ(heard.reassembly.messages(), 0U);
  EXPECT_EQ(heard.reassembly.bytes(), 0U);
}

TEST(Reassembly, BoundsTheMessagesOfASender) {
  ReassemblyLimits limits;
  limits.messages_of_sender = 2;
  HeardReassembly heard(limits);
  for (std::uint32_t i = 1; i <= 5; ++i) heard.take(fragment_datagrams(i, "R1_SCAN", counted(1000), 300)[0]);
  EXPECT_EQ(heard.reassembly.messages(), 2U);
  EXPECT_EQ(heard.drops, (std::map<std::string, int>{{"R1_SCAN fragments_lost", 3}}));
}

/// First fragments under made-up addresses, each of a message of its own.
void flood(HeardReassembly& heard, std::uint32_t count, std::size_t fragment_bytes) {
  const auto first = fragment_datagrams(1, "R9_SCAN", counted(3 * fragment_bytes), fragment_bytes)[0];
  for (std::uint32_t i = 0; i < count; ++i) heard.take(first, {0x0b000000 + i, 5000});
}

TEST(Reassembly, BoundsTheMessagesOfAllSenders) {
  HeardReassembly heard;
  flood(heard, 5000, 100);
  EXPECT_EQ(heard.reassembly.messages(), ReassemblyLimits().messages);
  EXPECT_EQ(heard.drops, (std::map<std::string, int>{{"R9_SCAN too_many_unfinished", 4000}}));
}

TEST(Reassembly, BoundsTheMemoryOfAllSenders) {
  HeardReassembly heard;
  flood(heard, 900, 60'000);
  EXPECT_LE(heard.reassembly.bytes(), ReassemblyLimits().bytes);
  EXPECT_GT(heard.reassembly.bytes(), ReassemblyLimits().bytes - 61'000);
  EXPECT_EQ(
      heard.reassembly.messages() + static_cast<std::size_t>(heard.drops["R9_SCAN too_many_unfinished"]),
      900U);
}

// Every fragment of R1's comes after hundreds of the flood's.
TEST(Reassembly, FinishesARobotsMessageInAFloodOfMadeUpSenders) {
  HeardReassembly heard;
  const auto datagrams = fragment_datagrams(1, "R1_SCAN", counted(200'000), 60'000);
  for (const Bytes& datagram : datagrams) {
    heard.take(datagram);
    flood(heard, 200, 60'000);
  }
  ASSERT_EQ(heard.messages.size(), 1U);
  EXPECT_EQ(heard.messages[0].second, counted(200'000));
}

}  // namespace
}  // namespace isthmus
