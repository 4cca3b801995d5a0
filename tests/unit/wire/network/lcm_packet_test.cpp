#include "server/wire/network/lcm_packet.hpp"

#include <gtest/gtest.h>

#include "tests/support/lcm_datagrams.hpp"

namespace isthmus {
namespace {

TestFragment middle_fragment() { return {5, 1000, 400, 2, 4, "", Bytes(300, 9)}; }

bool is_packet(const Bytes& datagram) { return parse_lcm_packet(datagram).has_value(); }

TEST(LcmPacket, ReadsAShortMessage) {
  const Bytes datagram = short_datagram(0x01020304, "R1_SCAN", Bytes{1, 2, 3});
  const auto packet = parse_lcm_packet(datagram);
  ASSERT_TRUE(packet);
  EXPECT_FALSE(packet->is_fragment);
  EXPECT_EQ(packet->sequence, 0x01020304U);
  EXPECT_EQ(packet->channel, "R1_SCAN");
  EXPECT_EQ(Bytes(packet->data.begin(), packet->data.end()), (Bytes{1, 2, 3}));
  EXPECT_TRUE(is_packet(short_datagram(1, std::string(63, 'x'), {}))) << "an empty message is one";
}

TEST(LcmPacket, ReadsFragments) {
  const Bytes datagram = fragment_datagram(middle_fragment());
  const auto packet = parse_lcm_packet(datagram);
  ASSERT_TRUE(packet);
  EXPECT_TRUE(packet->is_fragment);
  EXPECT_FALSE(packet->names_channel());
  EXPECT_EQ(packet->message_bytes, 1000U);
  EXPECT_EQ(packet->offset, 400U);
  EXPECT_EQ(packet->number, 2);
  EXPECT_EQ(packet->fragments, 4);
  EXPECT_EQ(packet->data.size(), 300U);
  const Bytes first = fragment_datagram({5, 1000, 0, 0, 4, "R1_SCAN", Bytes(300, 9)});
  EXPECT_EQ(parse_lcm_packet(first)->channel, "R1_SCAN");
  EXPECT_EQ(parse_lcm_packet(first)->data.size(), 300U);
}

TEST(LcmPacket, RefusesWhatIsCutShort) {
  const Bytes whole = short_datagram(1, "R1_SCAN", {});
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_FALSE(is_packet(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)))) << size;
  const Bytes first = fragment_datagram({1, 10, 0, 0, 2, "R1_SCAN", {}});
  for (std::size_t size = 0; size < first.size(); ++size)
    EXPECT_FALSE(is_packet(Bytes(first.begin(), first.begin() + static_cast<std::ptrdiff_t>(size)))) << size;
}

TEST(LcmPacket, RefusesOtherProtocols) {
  Bytes datagram = short_datagram(1, "R1_SCAN", {});
  datagram[3] += 2;
  EXPECT_FALSE(is_packet(datagram));
}

TEST(LcmPacket, RefusesChannelsThatAreTooLong) {
  EXPECT_FALSE(is_packet(short_datagram(1, std::string(64, 'x'), Bytes(100))));
  EXPECT_FALSE(is_packet(fragment_datagram({1, 1000, 0, 0, 2, std::string(64, 'x'), Bytes(100)})));
}

TEST(LcmPacket, RefusesFragmentsOutsideTheirMessage) {
  TestFragment fragment = middle_fragment();
  fragment.offset = 700;
  EXPECT_TRUE(is_packet(fragment_datagram(fragment)));
  fragment.offset = 701;
  EXPECT_FALSE(is_packet(fragment_datagram(fragment)));
  EXPECT_TRUE(is_packet(wrapped_offset_attack("R1_SCAN")[0]));
  EXPECT_FALSE(is_packet(wrapped_offset_attack("R1_SCAN")[1])) << "32 bits must not wrap";
}

TEST(LcmPacket, RefusesNumbersThatTheMessageDoesNotHave) {
  TestFragment fragment = middle_fragment();
  fragment.number = 4;
  EXPECT_FALSE(is_packet(fragment_datagram(fragment)));
  fragment.fragments = 0;
  fragment.number = 0;
  EXPECT_FALSE(is_packet(fragment_datagram(fragment)));
}

TEST(LcmPacket, RefusesAnEmptyFragmentAndAFirstOneThatIsNotAtTheBeginning) {
  TestFragment fragment = middle_fragment();
  fragment.data.clear();
  EXPECT_FALSE(is_packet(fragment_datagram(fragment)));
  EXPECT_FALSE(is_packet(fragment_datagram({1, 1000, 1, 0, 2, "R1_SCAN", Bytes(100)})));
}

}  // namespace
}  // namespace isthmus
