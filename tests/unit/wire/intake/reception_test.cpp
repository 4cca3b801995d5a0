#include "server/wire/intake/reception.hpp"

#include <gtest/gtest.h>

#include <chrono>

#include "server/wire/trust/envelope.hpp"
#include "tests/support/box_room.hpp"

namespace isthmus {
namespace {

std::vector<std::string> channels_in(Inbox& inbox) {
  std::vector<std::string> channels;
  while (const std::optional<Message> message = inbox.pop(std::chrono::milliseconds(0)))
    channels.push_back(message->channel);
  return channels;
}

TEST(Reception, LetsInInputChannelsAndNoOthers) {
  ChannelNames configured;
  configured["R2"].scan = "FRONT+REAR_SCAN";
  Inbox inbox({}, InboxOrder::arrival);
  Reception reception(inbox, configured);
  const LcmSink sink = reception.sink();
  const std::vector<std::uint8_t> bytes = {1, 2, 3};
  for (const std::string channel :
       {"R1_ODOMETRY", "R1_POSE", "ISTHMUS_MAP", "ISTHMUS_TICK", "ISTHMUS_CONFIGURATION", "xISTHMUS_TAG",
        "ISTHMUS_TAG", "FRONT+REAR_SCAN", "r3_scan", "R1_SCANS", "R4_SCAN"}) {
    if (sink.wants(channel)) sink.deliver(1, channel, bytes);
  }
  EXPECT_EQ(channels_in(inbox), (std::vector<std::string>{"R1_ODOMETRY", "ISTHMUS_TAG", "FRONT+REAR_SCAN",
                                                          "r3_scan", "R4_SCAN"}));
}

TEST(Reception, RefusesStrangersAndLetsInWhatFollowsAnIntroductionAtOnce) {
  std::vector<std::string> told;
  const Log log = [&](LogLevel, std::string_view, const LogFields& fields) {
    told.push_back(fields[0].second);
  };
  Inbox inbox({}, InboxOrder::arrival);
  inbox.refuse_strangers();
  Reception reception(inbox, ChannelNames{}, Authenticator(), log);
  const BoxRoomRobot robot("R1");
  const auto take = [&](const std::string& channel, const std::vector<std::uint8_t>& bytes) {
    reception.take(1, channel, bytes);
  };
  for (const Message& message : robot.round(0)) take(message.channel, message.bytes);
  take("R1_ROBOT", {1, 2, 3});  // no introduction
  for (const Message& message : robot.round(1)) take(message.channel, message.bytes);
  take("R1_ROBOT", robot.introduction().bytes);
  for (const Message& message : robot.round(2)) take(message.channel, message.bytes);
  for (int i = 0; i < 100; ++i) take("X" + std::to_string(i) + "_SIGHTING", {1, 2, 3});
  take("ISTHMUS_TAG", encode({1, TagEvent{1, 7}}).bytes);
  EXPECT_EQ(channels_in(inbox),
            (std::vector<std::string>{"R1_ROBOT", "R1_ROBOT", "R1_ODOMETRY", "R1_SCAN", "ISTHMUS_TAG"}));
  EXPECT_EQ(inbox.take_drops().at("(others)").at(DropReason::unknown_robot).count, 4 + 100);
  EXPECT_EQ(told.size(), 16U) << "names of strangers, a bounded number";
  EXPECT_EQ(told.front(), "R1");
}

// What a page of the server posts, say: the same keys hold, and the same counters.
TEST(Reception, TellsWhoeverBroughtAMessageWhyItIsRefused) {
  const AuthKey key{1, 2, 3};
  Authentication keys;
  keys.operators["ALICE"] = key;
  Inbox inbox({}, InboxOrder::arrival);
  Reception reception(inbox, ChannelNames{}, Authenticator(keys));
  const Message order = encode({7, CommandEvent{7, Verb::withdraw, 3, ""}});
  const auto take = [&](const Message& message) { return reception.take(1, message.channel, message.bytes); };
  EXPECT_EQ(take(order), DropReason::not_signed);
  EXPECT_EQ(take(seal({}, "ALICE", 7, order)), DropReason::forged);
  EXPECT_EQ(take(seal(key, "BOB", 7, order)), DropReason::unknown_sender);
  EXPECT_EQ(take(seal(key, "ALICE", 7, order)), DropReason::none);
  EXPECT_EQ(take(seal(key, "ALICE", 7, order)), DropReason::replayed);
  EXPECT_EQ(channels_in(inbox), (std::vector<std::string>{"ISTHMUS_COMMAND"}));
}

}  // namespace
}  // namespace isthmus
