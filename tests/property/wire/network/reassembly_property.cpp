#include "server/wire/network/reassembly.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <map>
#include <random>
#include <set>

#include "tests/support/lcm_datagrams.hpp"

namespace isthmus {
namespace {

/// std::mt19937's numbers as the 32 bits that they are.
struct Random {
  using result_type = std::uint32_t;
  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return 0xffffffff; }
  result_type operator()() { return static_cast<result_type>(engine()); }
  std::mt19937 engine;
};

/// A message somewhere on the network.
struct Sent {
  LcmSender sender;
  std::string channel;
  Bytes bytes;
  std::vector<Bytes> datagrams;
};

/// Each with an own number of its sender's and bytes that tell it from all others.
Sent message_of(std::uint16_t port, std::uint32_t sequence, Random& random) {
  Sent sent;
  sent.sender = {0x0a000001, port};
  sent.channel = "R" + std::to_string(port) + "_SCAN";
  sent.bytes.resize(1 + random() % 5000);
  for (std::uint8_t& byte : sent.bytes) byte = static_cast<std::uint8_t>(random());
  const std::size_t fragment_bytes = 100 + random() % 1500;
  sent.datagrams = fragment_datagrams(sequence, sent.channel, sent.bytes, fragment_bytes);
  return sent;
}

/// A datagram on its way, and the message that it belongs to.
struct Travelling {
  std::size_t message = 0;
  std::size_t fragment = 0;
};

/// Three senders' messages in rounds of at most as many as a sender may have under assembly, so that all of a
/// round may be mixed; in each round some datagrams are lost and some doubled.
struct Arrivals {
  std::vector<Sent> messages;
  std::vector<Travelling> order;
  std::set<std::size_t> lost;  ///< messages that miss a datagram

  explicit Arrivals(std::uint32_t seed) {
    Random random{std::mt19937(seed)};
    std::uint32_t sequence = random();  // it may wrap
    for (int round = 0; round < 4; ++round) add_round(sequence, random);
  }

  void add_round(std::uint32_t& sequence, Random& random) {
    const std::size_t of_sender = 1 + random() % ReassemblyLimits().messages_of_sender;
    std::vector<Travelling> mixed;
    for (std::size_t i = 0; i < of_sender; ++i, ++sequence) {
      for (std::uint16_t port = 1; port <= 3; ++port) {
        messages.push_back(message_of(port, sequence, random));
        for (std::size_t k = 0; k < messages.back().datagrams.size(); ++k) {
          const bool is_lost = random() % 40 == 0;
          if (is_lost) lost.insert(messages.size() - 1);
          for (std::size_t copies = is_lost ? 0 : 1 + random() % 8 / 7; copies > 0; --copies)
            mixed.push_back({messages.size() - 1, k});
        }
      }
    }
    std::shuffle(mixed.begin(), mixed.end(), random);
    order.insert(order.end(), mixed.begin(), mixed.end());
  }
};

RC_GTEST_PROP(Reassembly, HandsOnEachWholeMessageOnceAndNothingElse, (std::uint32_t seed)) {
  const Arrivals arrivals(seed);
  std::map<std::pair<std::string, Bytes>, int> heard;
  std::size_t drops = 0;
  Reassembly reassembly({[](std::string_view) { return true; },
                         [&](std::int64_t, std::string_view channel, std::span<const std::uint8_t> bytes) {
                           heard[{std::string(channel), {bytes.begin(), bytes.end()}}] += 1;
                         },
                         [&](std::string_view, DropReason) { ++drops; }});
  for (const auto& [message, fragment] : arrivals.order) {
    const Sent& sent = arrivals.messages[message];
    reassembly.take(sent.sender, sent.datagrams[fragment], 1, 1);
  }
  std::map<std::pair<std::string, Bytes>, int> expected;
  for (std::size_t i = 0; i < arrivals.messages.size(); ++i) {
    if (!arrivals.lost.contains(i)) expected[{arrivals.messages[i].channel, arrivals.messages[i].bytes}] += 1;
  }
  RC_ASSERT(heard == expected);
  RC_ASSERT(drops <= arrivals.lost.size());
}

/// Anything: heads that are right and wrong, of a few senders and messages.
Bytes any_datagram(Random& random) {
  TestFragment fragment;
  fragment.sequence = random() % 20;
  fragment.fragments = static_cast<std::uint16_t>(random() % 6);
  fragment.number = static_cast<std::uint16_t>(random() % 6);
  fragment.message_bytes = random() % 4 == 0 ? random() : 1000 * (1 + random() % 4);
  fragment.offset = random() % 8 == 0 ? random() : 250 * (random() % 8);
  fragment.channel = random() % 2 == 0 ? "R1_SCAN" : "CAMERA";
  fragment.data.resize(random() % 3 == 0 ? random() % 3000 : 250 * (random() % 5));
  Bytes datagram = fragment_datagram(fragment);
  if (random() % 10 == 0) datagram.resize(random() % (datagram.size() + 1));
  return datagram;
}

RC_GTEST_PROP(Reassembly, StaysWithinItsBoundsWhateverComes, (std::uint32_t seed)) {
  Random random{std::mt19937(seed)};
  ReassemblyLimits limits;
  limits.message_bytes = 4000;
  limits.bytes = 10'000;
  limits.messages = 30;
  limits.messages_of_sender = 4;
  limits.fragments = 5;
  Reassembly reassembly({[](std::string_view channel) { return channel == "R1_SCAN"; },
                         [&](std::int64_t, std::string_view channel, std::span<const std::uint8_t> bytes) {
                           RC_ASSERT(channel == "R1_SCAN");
                           RC_ASSERT(bytes.size() <= limits.message_bytes);
                         },
                         [](std::string_view, DropReason) {}},
                        limits);
  for (std::int64_t now_us = 0; now_us < 3'000'000; now_us += random() % 5000) {
    reassembly.take({1, static_cast<std::uint16_t>(random() % 12)}, any_datagram(random), 1, now_us);
    RC_ASSERT(reassembly.bytes() <= limits.bytes);
    RC_ASSERT(reassembly.messages() <= limits.messages);
  }
  const Bytes last = short_datagram(1, "CAMERA", {});
  reassembly.take({1, 1}, last, 1, 10'000'000);
  RC_ASSERT(reassembly.bytes() == 0U);
  RC_ASSERT(reassembly.messages() == 0U);
}

}  // namespace
}  // namespace isthmus
