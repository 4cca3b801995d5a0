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
  const auto mistakes = std::make_shared<Mistakes>();
  Inbox inbox({}, InboxOrder::arrival);
  inbox.refuse_strangers();
  Reception reception(inbox, ChannelNames{}, Authenticator(), {{}, mistakes});
  const BoxRoomRobot robot("R1");
  const auto take = [&](const std::string& channel, const std::vector<std::uint8_t>& bytes) {
    reception.take(1, channel, bytes);
  };
  for (const Message& message : robot.round(0)) take(message.channel, message.bytes);
  take("R1_ROBOT", {1, 2, 3});  // no introduction
  for (const Message& message : robot.round(1)) take(message.channel, message.bytes);
  take("R1_ROBOT", robot.introduction().bytes);
  for (const Message& message : robot.round(2)) take(message.channel, message.bytes);
  for (int i = 0; i < 40; ++i) take("X" + std::to_string(i) + "_SIGHTING", {1, 2, 3});
  take("ISTHMUS_TAG", encode({1, TagEvent{1, 7}}).bytes);
  EXPECT_EQ(channels_in(inbox),
            (std::vector<std::string>{"R1_ROBOT", "R1_ROBOT", "R1_ODOMETRY", "R1_SCAN", "ISTHMUS_TAG"}));
  EXPECT_EQ(inbox.take_drops().at("(others)").at(DropReason::unknown_robot).count, 4 + 40);
  EXPECT_TRUE(mistakes->warnings().empty())
      << "four messages before the first introduction, and one of each X";
  for (int i = 0; i < 5; ++i) take("X_SIGHTING", {1, 2, 3});
  ASSERT_EQ(mistakes->warnings().size(), 1U);
  EXPECT_EQ(mistakes->warnings()[0].kind, "not_introduced");
  EXPECT_EQ(mistakes->warnings()[0].robot, "X");
}

// As while a server reads its journal: nobody is refused yet, and the engine has not seen the introduction.
TEST(Reception, KnowsWhoIntroducedItselfBeforeStrangersWereRefused) {
  Inbox inbox({}, InboxOrder::arrival);
  Reception reception(inbox, ChannelNames{});
  const BoxRoomRobot robot("R1");
  EXPECT_EQ(reception.take(1, "R1_ROBOT", robot.introduction().bytes), DropReason::none);
  inbox.refuse_strangers();
  for (const Message& message : robot.round(0))
    EXPECT_EQ(reception.take(1, message.channel, message.bytes), DropReason::none) << message.channel;
}

// Whoever says where a robot is waits for the answer, also where nobody knows the robot.
TEST(Reception, TellsThatAnInitialPoseIsOfNoRobot) {
  Inbox inbox({}, InboxOrder::arrival);
  inbox.refuse_strangers();
  std::vector<std::pair<std::string, DropReason>> told;
  Reception reception(inbox, ChannelNames{}, Authenticator(),
                      {[&](const command_t& order, DropReason reason, std::int64_t) {
                         told.emplace_back(order.robot, reason);
                       },
                       nullptr});
  InitialPoseEvent pose;
  pose.robot = "R9";
  pose.utime = 7;
  pose.patch = PatchId{0};
  pose.sigma_m = pose.sigma_rad = 1;
  const Message message = encode({7, pose});
  EXPECT_EQ(reception.take(1, message.channel, message.bytes), DropReason::unknown_robot);
  EXPECT_EQ(told, (std::vector<std::pair<std::string, DropReason>>{{"R9", DropReason::unknown_robot}}));
  EXPECT_EQ(inbox.size(), 0U);
}

TEST(Reception, HearsOtherServersAndNotThisOne) {
  Inbox inbox({}, InboxOrder::arrival);
  const auto mistakes = std::make_shared<Mistakes>();
  Reception reception(inbox, ChannelNames{}, Authenticator(), {{}, mistakes});
  const LcmSink sink = reception.sink();
  ASSERT_TRUE(sink.wants("ISTHMUS_STATUS"));
  const std::vector<std::uint8_t> own = {1, 2, 3}, another = {1, 2, 4};
  for (int i = 0; i < 9; ++i) {
    mistakes->sent_status(own);
    sink.deliver(1, "ISTHMUS_STATUS", own);
  }
  EXPECT_TRUE(mistakes->warnings().empty());
  for (int i = 0; i < 9; ++i) sink.deliver(1, "ISTHMUS_STATUS", another);
  ASSERT_EQ(mistakes->warnings().size(), 1U);
  EXPECT_EQ(mistakes->warnings()[0].kind, "other_server");
  EXPECT_EQ(inbox.size(), 0U);
  EXPECT_FALSE(Reception(inbox, ChannelNames{}).sink().wants("ISTHMUS_STATUS"));
}

// What a page of the server posts, say: the same keys hold, and the same counters.
TEST(Reception, TellsWhoeverBroughtAMessageWhyItIsRefused) {
  const AuthKey key{1, 2, 3};
  Authentication keys;
  keys.operators["ALICE"] = key;
  Inbox inbox({}, InboxOrder::arrival);
  std::vector<DropReason> told;
  Reception reception(inbox, ChannelNames{}, Authenticator(keys),
                      {[&](const command_t& order, DropReason reason, std::int64_t utime) {
                         EXPECT_EQ(order.utime, 7);
                         EXPECT_EQ(order.closure, 3);
                         EXPECT_EQ(utime, 1);
                         told.push_back(reason);
                       },
                       nullptr});
  const Message order = encode({7, CommandEvent{7, Verb::withdraw, 3, ""}});
  const auto take = [&](const Message& message) { return reception.take(1, message.channel, message.bytes); };
  EXPECT_EQ(take(order), DropReason::not_signed);
  EXPECT_EQ(take(seal({}, "ALICE", 7, order)), DropReason::forged);
  EXPECT_EQ(take(seal(key, "BOB", 7, order)), DropReason::unknown_sender);
  EXPECT_EQ(take(seal(key, "ALICE", 7, order)), DropReason::none);
  EXPECT_EQ(take(seal(key, "ALICE", 7, order)), DropReason::replayed);
  EXPECT_EQ(take(encode({7, TagEvent{7, 3}})), DropReason::not_signed);  // no order
  EXPECT_EQ(told, (std::vector<DropReason>{DropReason::not_signed, DropReason::forged,
                                           DropReason::unknown_sender, DropReason::replayed}));
  EXPECT_EQ(channels_in(inbox), (std::vector<std::string>{"ISTHMUS_COMMAND"}));
}

}  // namespace
}  // namespace isthmus
