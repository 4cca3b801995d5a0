#include "server/wire/live/lcm_link.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <iomanip>
#include <lcm/lcm-cpp.hpp>
#include <sstream>
#include <thread>

#include "tests/support/box_room.hpp"
#include "tests/support/lcm_datagrams.hpp"
#include "tests/support/log_files.hpp"
#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

using std::chrono::milliseconds;

/// What arrives, until there are so many or nothing comes for ten seconds.
std::vector<Message> wait_for(Inbox& inbox, std::size_t count) {
  std::vector<Message> messages;
  while (messages.size() < count) {
    std::optional<Message> message = inbox.pop(milliseconds(10'000));
    if (!message) break;
    messages.push_back(std::move(*message));
  }
  return messages;
}

TEST(LcmUrl, AsksForALargeReceiveBufferUnlessTheUserDid) {
  EXPECT_EQ(complete_lcm_url("udpm://239.255.76.67:7667?ttl=0"),
            "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304");
  EXPECT_EQ(complete_lcm_url("udpm://"), "udpm://?recv_buf_size=4194304");
  EXPECT_EQ(complete_lcm_url("udpm://?recv_buf_size=1000"), "udpm://?recv_buf_size=1000");
  EXPECT_EQ(complete_lcm_url("memq://"), "memq://");
  EXPECT_EQ(complete_lcm_url("file:///a.lcm"), "file:///a.lcm");
}

TEST(LcmUrl, WarnsOfWhatLeavesTheMachineAndOfASmallBuffer) {
  const std::string url = "udpm://239.255.76.67:7667?ttl=0&recv_buf_size=4194304";
  EXPECT_TRUE(lcm_url_warnings(url, 4194304).empty());
  EXPECT_EQ(lcm_url_warnings(url, 212992).size(), 1U);
  EXPECT_EQ(lcm_url_warnings("udpm://?ttl=1&recv_buf_size=1000", 212992).size(), 1U);
  EXPECT_EQ(lcm_url_warnings("udpm://?recv_buf_size=4194304&ttl=2", 212992).size(), 2U);
  EXPECT_TRUE(lcm_url_warnings("memq://", 1).empty());
}

TEST(LcmUrl, NamesTheLogOfAFile) {
  EXPECT_EQ(log_file_of("file:///a/b.lcm?speed=0"), "/a/b.lcm");
  EXPECT_EQ(log_file_of("file://b.lcm"), "b.lcm");
  EXPECT_EQ(log_file_of("memq://"), "");
}

TEST(LcmLink, SaysWhatToDoWhereTheNetworkCannotBeOpened) {
  const std::string error = error_of([] { LcmLink link("udpm://not-an-address"); });
  EXPECT_NE(error.find("ip route add 224.0.0.0/4 dev lo"), std::string::npos) << error;
}

// One message: liblcm's queue has locks that the thread sanitizer does not see, and a pipe for the first
// message that it does.
TEST(LcmLink, HearsAQueueOfThisProcessAndNotItsOutputs) {
  LcmLink link("memq://");
  Inbox inbox({}, InboxOrder::arrival);
  ChannelNames configured;
  configured["R2"].scan = "FRONT+REAR_SCAN";
  link.receive_into(inbox, configured);
  for (const char* channel : {"R1_POSE", "ISTHMUS_MAP", "ISTHMUS_TICK", "xISTHMUS_TAG", "FRONT+REAR_SCAN"})
    link.publish(channel, {1, 2, 3});
  const std::vector<Message> received = wait_for(inbox, 1);
  ASSERT_EQ(received.size(), 1U);
  EXPECT_EQ(received[0].channel, "FRONT+REAR_SCAN");
  link.stop();
  EXPECT_EQ(inbox.size(), 0U);
}

TEST(LcmLink, TakesWhatCameAnotherWayAsIfTheNetworkHadBroughtIt) {
  LcmLink link("memq://");
  Inbox inbox({}, InboxOrder::arrival);
  link.receive_into(inbox, ChannelNames{});
  const std::vector<std::uint8_t> bytes = {1, 2, 3};
  EXPECT_EQ(link.take("ISTHMUS_COMMAND", bytes), DropReason::none);
  EXPECT_EQ(link.take("R1_POSE", bytes), DropReason::none) << "none of ours";
  ASSERT_EQ(inbox.size(), 1U);
  EXPECT_EQ(inbox.pop(milliseconds(0))->channel, "ISTHMUS_COMMAND");
}

TEST(LcmLink, ReadsALogToItsEndWithoutLoss) {
  TemporaryDirectory directory;
  std::vector<Message> messages;
  for (int i = 0; i < 200; ++i) {
    for (const Message& message : BoxRoomRobot("R1").round(i)) messages.push_back(message);
  }
  write_log(directory / "a.lcm", messages);
  InboxLimits limits;
  limits.messages = 10;
  Inbox inbox(limits);
  LcmLink link("file://" + (directory / "a.lcm"));
  link.receive_into(inbox, ChannelNames{});
  const std::vector<Message> received = wait_for(inbox, messages.size());
  ASSERT_EQ(received.size(), messages.size());
  for (std::size_t i = 0; i < messages.size(); ++i) EXPECT_TRUE(same(received[i], messages[i])) << i;
  const auto deadline = std::chrono::steady_clock::now() + milliseconds(10'000);
  while (!link.ended() && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
  EXPECT_TRUE(link.ended());
}

/// Whether this machine lets UDP multicast be tested.
bool has_multicast() { return lcm::LCM(test_udp_url()).good(); }

TEST(LcmLink, HearsUdpFromItsConstructionOn) {
  if (!has_multicast()) GTEST_SKIP() << "no multicast route on this machine";
  lcm::LCM sender(test_udp_url());
  LcmLink link(test_udp_url());
  const Message message = BoxRoomRobot("R1").round(1)[1];
  for (const std::string channel : {"R1_POSE", "ISTHMUS_TICK", message.channel.c_str()})
    sender.publish(channel, message.bytes.data(), static_cast<unsigned>(message.bytes.size()));
  Inbox inbox;
  link.receive_into(inbox, ChannelNames{});
  const std::vector<Message> received = wait_for(inbox, 1);
  ASSERT_EQ(received.size(), 1U);
  EXPECT_EQ(received[0].channel, "R1_SCAN");
  EXPECT_EQ(received[0].bytes, message.bytes);
}

// Two datagrams that kill whoever receives them with liblcm 1.3.1.
TEST(LcmLink, SurvivesAFragmentBeyondItsMessage) {
  if (!has_multicast()) GTEST_SKIP() << "no multicast route on this machine";
  LcmLink link(test_udp_url());
  Inbox inbox;
  link.receive_into(inbox, ChannelNames{});
  const DatagramSender attacker;
  for (const std::string channel : {"R1_SCAN", "R1_POSE", "ISTHMUS_SIGNED"}) {
    for (const Bytes& datagram : wrapped_offset_attack(channel)) ASSERT_TRUE(attacker.send(datagram));
  }
  const Message message = BoxRoomRobot("R1").round(1)[1];
  link.publish(message.channel, message.bytes);
  const std::vector<Message> received = wait_for(inbox, 1);
  ASSERT_EQ(received.size(), 1U);
  EXPECT_EQ(received[0].bytes, message.bytes);
  EXPECT_EQ(inbox.take_drops().at("").at(DropReason::malformed_packet).count, 3);
}

/// Sockets of this machine that are bound to a UDP port.
int sockets_on(std::uint16_t port) {
  std::ifstream table("/proc/net/udp");
  std::ostringstream address;
  address << ":" << std::uppercase << std::hex << std::setw(4) << std::setfill('0') << port << " ";
  int count = 0;
  for (std::string line; std::getline(table, line);) count += line.find(address.str()) < 20 ? 1 : 0;
  return count;
}

TEST(LcmLink, LetsLiblcmReceiveNothingFromUdp) {
  if (!has_multicast()) GTEST_SKIP() << "no multicast route on this machine";
  ASSERT_EQ(sockets_on(test_udp_port()), 0);
  LcmLink link(test_udp_url());
  Inbox inbox;
  link.receive_into(inbox, ChannelNames{});
  link.publish("R1_POSE", {1, 2, 3});
  EXPECT_EQ(sockets_on(test_udp_port()), 1) << "ours";
  lcm::LCM other(test_udp_url());
  other.subscribeFunction<void*>(
      "NONE", +[](const lcm::ReceiveBuffer*, const std::string&, void*) {}, nullptr);
  EXPECT_EQ(sockets_on(test_udp_port()), 2) << "liblcm's are counted";
}

}  // namespace
}  // namespace isthmus
