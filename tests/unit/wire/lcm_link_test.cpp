#include "server/wire/lcm_link.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <lcm/lcm-cpp.hpp>
#include <thread>

#include "tests/support/box_room.hpp"
#include "tests/support/log_files.hpp"
#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

using std::chrono::milliseconds;

/// What arrives, until there are so many or nothing comes for two seconds.
std::vector<Message> wait_for(Inbox& inbox, std::size_t count) {
  std::vector<Message> messages;
  while (messages.size() < count) {
    std::optional<Message> message = inbox.pop(milliseconds(2000));
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

TEST(LcmLink, CopiesInputChannelsOnceAndNoOthers) {
  LcmLink link("memq://");
  Configuration configuration;
  configuration.robots["R2"].scan_channel = "FRONT+REAR_SCAN";
  Inbox inbox({}, InboxOrder::arrival);
  link.receive_into(inbox, configuration);
  for (const char* channel :
       {"R1_ODOMETRY", "R1_POSE", "ISTHMUS_MAP", "ISTHMUS_TICK", "ISTHMUS_CONFIGURATION", "xISTHMUS_TAG",
        "ISTHMUS_TAG", "FRONT+REAR_SCAN", "r3_scan", "R1_SCANS"}) {
    link.publish(channel, {1, 2, 3});
  }
  std::vector<std::string> channels;
  for (const Message& message : wait_for(inbox, 4)) channels.push_back(message.channel);
  EXPECT_EQ(channels, (std::vector<std::string>{"R1_ODOMETRY", "ISTHMUS_TAG", "FRONT+REAR_SCAN", "r3_scan"}));
  EXPECT_FALSE(inbox.pop(milliseconds(50)));
  link.stop();
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
  link.receive_into(inbox, Configuration{});
  const std::vector<Message> received = wait_for(inbox, messages.size());
  ASSERT_EQ(received.size(), messages.size());
  for (std::size_t i = 0; i < messages.size(); ++i) EXPECT_TRUE(same(received[i], messages[i])) << i;
  for (int i = 0; i < 100 && !link.ended(); ++i) std::this_thread::sleep_for(milliseconds(20));
  EXPECT_TRUE(link.ended());
}

TEST(LcmLink, HearsUdp) {
  const std::string url = "udpm://239.255.76.67:17667?ttl=0";
  lcm::LCM sender(url);
  if (!sender.good()) GTEST_SKIP() << "no multicast route on this machine";
  LcmLink link(url);
  Inbox inbox;
  link.receive_into(inbox, Configuration{});
  const Message message = BoxRoomRobot("R1").round(1)[1];
  // Again while nothing comes: the first may be sent before the receiver has joined its group.
  for (int i = 0; i < 20 && inbox.size() == 0; ++i) {
    sender.publish(message.channel, message.bytes.data(), static_cast<unsigned>(message.bytes.size()));
    std::this_thread::sleep_for(milliseconds(50));
  }
  const std::vector<Message> received = wait_for(inbox, 1);
  ASSERT_EQ(received.size(), 1U);
  EXPECT_EQ(received[0].channel, "R1_SCAN");
  EXPECT_EQ(received[0].bytes, message.bytes);
}

}  // namespace
}  // namespace isthmus
