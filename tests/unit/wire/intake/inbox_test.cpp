#include "server/wire/intake/inbox.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>

namespace isthmus {
namespace {

using std::chrono::milliseconds;

InboxLimits three_messages() {
  InboxLimits limits;
  limits.messages = 3;
  return limits;
}

void push(Inbox& inbox, const std::string& robot, std::int64_t utime, bool is_scan, std::size_t size = 1) {
  inbox.push(robot, is_scan, utime, robot + (is_scan ? "_SCAN" : "_ODOMETRY"),
             std::vector<std::uint8_t>(size));
}

std::vector<std::int64_t> pop_all(Inbox& inbox) {
  std::vector<std::int64_t> utimes;
  while (auto message = inbox.pop(milliseconds(0))) utimes.push_back(message->utime);
  return utimes;
}

TEST(Inbox, KeepsALogsOrderAcrossRobots) {
  Inbox inbox({}, InboxOrder::arrival);
  push(inbox, "R1", 1, true);
  push(inbox, "R2", 2, false);
  push(inbox, "R1", 3, false);
  push(inbox, "R2", 4, true);
  EXPECT_EQ(pop_all(inbox), (std::vector<std::int64_t>{1, 2, 3, 4}));
}

//   R1: 1 2 3 4 5 ...   R2: 1001   R3: 1002 1003
TEST(Inbox, ServesRobotsInTurnSoThatAFloodDelaysNobodyElse) {
  Inbox inbox;
  for (int i = 1; i <= 1000; ++i) push(inbox, "R1", i, i % 2 == 0);
  push(inbox, "R2", 1001, true);
  push(inbox, "R3", 1002, false);
  push(inbox, "R3", 1003, true);
  const std::vector<std::int64_t> popped = pop_all(inbox);
  ASSERT_EQ(popped.size(), 1003U);
  EXPECT_EQ((std::vector<std::int64_t>(popped.begin(), popped.begin() + 6)),
            (std::vector<std::int64_t>{1, 1001, 1002, 2, 1003, 3}));
  EXPECT_TRUE(std::is_sorted(popped.begin() + 6, popped.end()));
}

TEST(Inbox, HasAPlaceForARobotAfterAFloodOfNames) {
  InboxLimits limits = three_messages();
  limits.senders = 2;
  Inbox inbox(limits);
  for (int i = 0; i < 100; ++i) push(inbox, "X" + std::to_string(i), i, true);
  pop_all(inbox);
  inbox.take_drops();
  for (int i = 0; i < 4; ++i) push(inbox, "R1", i, true);
  EXPECT_TRUE(inbox.take_drops().contains("R1"));
}

TEST(Inbox, KeepsAQueueForARobotWhoseNameIsReserved) {
  InboxLimits limits = three_messages();
  limits.senders = 2;
  Inbox inbox(limits);
  inbox.reserve("R1");
  for (int i = 0; i < 100; ++i) push(inbox, "X" + std::to_string(i), i, true);
  for (int i = 0; i < 4; ++i) push(inbox, "R1", i, true);
  EXPECT_EQ(inbox.take_drops().at("R1").at(DropReason::queue_full).count, 1);
}

TEST(Inbox, DropsTheOldestScanOfTheRobotThatFloods) {
  Inbox inbox(three_messages(), InboxOrder::arrival);
  push(inbox, "R2", 1, true);
  push(inbox, "R1", 2, false);
  push(inbox, "R1", 3, true);
  push(inbox, "R1", 4, true);
  push(inbox, "R1", 5, false);
  EXPECT_EQ(pop_all(inbox), (std::vector<std::int64_t>{1, 2, 4, 5}));
  const auto drops = inbox.take_drops();
  ASSERT_EQ(drops.size(), 1U);
  EXPECT_EQ(drops.at("R1").at(DropReason::queue_full).count, 1);
  EXPECT_TRUE(inbox.take_drops().empty());
}

TEST(Inbox, DropsTheOldestMessageWhereThereIsNoScan) {
  Inbox inbox(three_messages());
  for (int i = 1; i <= 5; ++i) push(inbox, "R1", i, false);
  EXPECT_EQ(pop_all(inbox), (std::vector<std::int64_t>{3, 4, 5}));
}

TEST(Inbox, IsBoundedInBytes) {
  InboxLimits limits;
  limits.bytes = 100;
  Inbox inbox(limits);
  for (int i = 1; i <= 5; ++i) push(inbox, "R1", i, true, 40);
  EXPECT_EQ(pop_all(inbox), (std::vector<std::int64_t>{4, 5}));
}

TEST(Inbox, RefusesMessagesThatAreTooLong) {
  InboxLimits limits;
  limits.message_bytes = 10;
  Inbox inbox(limits);
  push(inbox, "R1", 1, true, 11);
  EXPECT_EQ(inbox.size(), 0U);
  EXPECT_EQ(inbox.take_drops().at("R1").at(DropReason::bad_length).count, 1);
}

TEST(Inbox, BoundsTheNumberOfQueues) {
  InboxLimits limits = three_messages();
  limits.senders = 2;
  Inbox inbox(limits);
  for (int i = 0; i < 100; ++i) push(inbox, "R" + std::to_string(i), i, true);
  EXPECT_EQ(inbox.size(), 2U + 3U);
}

TEST(Inbox, HandsOutWhatItHoldsAfterItWasClosed) {
  Inbox inbox;
  push(inbox, "R1", 1, true);
  inbox.close();
  push(inbox, "R1", 2, true);
  EXPECT_FALSE(inbox.finished());
  EXPECT_EQ(pop_all(inbox), (std::vector<std::int64_t>{1}));
  EXPECT_TRUE(inbox.finished());
}

TEST(Inbox, LetsAPatientSourceWaitInsteadOfDropping) {
  Inbox inbox(three_messages());
  std::thread source([&] {
    const std::vector<std::uint8_t> bytes(1);
    for (int i = 0; i < 1000; ++i) inbox.push_waiting("R1", true, i, "R1_SCAN", bytes);
    inbox.close();
  });
  std::int64_t expected = 0;
  while (!inbox.finished()) {
    const auto message = inbox.pop(milliseconds(100));
    if (!message) continue;
    EXPECT_EQ(message->utime, expected);
    expected += 1;
  }
  source.join();
  EXPECT_EQ(expected, 1000);
  EXPECT_TRUE(inbox.take_drops().empty());
}

TEST(Inbox, TellsStrangersFromRobotsOnceAllOnTheMapAreReserved) {
  InboxLimits limits;
  limits.robots = 2;
  Inbox inbox(limits);
  inbox.reserve("R1");
  EXPECT_FALSE(inbox.is_stranger("X1")) << "who is on the map is not known yet";
  inbox.refuse_strangers();
  EXPECT_FALSE(inbox.is_stranger("R1"));
  EXPECT_TRUE(inbox.is_stranger("R2"));
  inbox.introduce("R2");
  EXPECT_FALSE(inbox.is_stranger("R2"));
  inbox.introduce("R3");
  EXPECT_TRUE(inbox.is_stranger("R3")) << "no more than a map is for";
}

TEST(Inbox, CountsTheDropsOfMadeUpNamesTogether) {
  Inbox inbox;
  for (int i = 0; i < 200'000; ++i) inbox.count_drop("X" + std::to_string(i), DropReason::not_signed);
  const auto drops = inbox.take_drops();
  EXPECT_LE(drops.size(), InboxLimits().senders + 1);
  EXPECT_TRUE(drops.contains("(others)"));
}

TEST(Inbox, LetsAPatientSourceGoWhenClosed) {
  Inbox inbox(three_messages());
  const std::vector<std::uint8_t> bytes(1);
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(inbox.push_waiting("R1", true, i, "R1_SCAN", bytes));
  std::thread source([&] { EXPECT_FALSE(inbox.push_waiting("R1", true, 3, "R1_SCAN", bytes)); });
  inbox.close();
  source.join();
}

}  // namespace
}  // namespace isthmus
