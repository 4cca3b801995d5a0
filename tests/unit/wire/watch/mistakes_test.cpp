#include "server/wire/watch/mistakes.hpp"

#include <gtest/gtest.h>

#include "server/wire/message/message.hpp"
#include "tests/support/box_room.hpp"

namespace isthmus {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t now_utime = 1'800'000'000'000'000;  // 2027

/// Messages as the server sees them, on a clock of its own.
struct Server {
  Mistakes::Clock::time_point time;
  Mistakes mistakes{[this] { return time; }};

  /// So many messages, with why each was refused.
  void take(const Event& event, int times, DropReason reason = DropReason::none) {
    const Message message = encode(event);
    for (int i = 0; i < times; ++i)
      mistakes.note(*find_channel({}, message.channel), message.bytes, reason, now_utime);
  }
  /// "kind robot: text" of each that holds.
  std::vector<std::string> told() {
    std::vector<std::string> lines;
    for (const LiveWarning& one : mistakes.warnings())
      lines.push_back(one.kind + " " + one.robot + ": " + one.text);
    return lines;
  }
};

using Lines = std::vector<std::string>;

Event scan(std::int64_t utime = now_utime) {
  return {now_utime, ScanEvent{"R1", {utime, 0, 0.1, {1, 2, 3}}}};
}

Event introduction(bool restarted) {
  RobotEvent robot;
  robot.robot = "R1";
  robot.utime = now_utime;
  robot.restarted = restarted;
  return {now_utime, robot};
}

TEST(Mistakes, ScansBeforeAnIntroduction) {
  Server server;
  server.take(scan(), 4, DropReason::unknown_robot);
  EXPECT_EQ(server.told(), Lines{}) << "the introduction may be on its way";
  server.take(scan(), 1, DropReason::unknown_robot);
  EXPECT_EQ(server.told(),
            Lines{"not_introduced R1: R1 sends scans but has not said who it is: R1_ROBOT comes first"});
}

TEST(Mistakes, OneEndsSomeTimeAfterItsLastMessage) {
  Server server;
  server.take(scan(), 5, DropReason::unknown_robot);
  server.time += 9s;
  EXPECT_EQ(server.told().size(), 1U);
  server.take(scan(), 1, DropReason::unknown_robot);
  server.time += 9s;
  EXPECT_EQ(server.told().size(), 1U);
  server.time += 2s;
  EXPECT_EQ(server.told(), Lines{});
  server.take(scan(), 1, DropReason::unknown_robot);
  EXPECT_EQ(server.told(), Lines{}) << "begins anew";
}

TEST(Mistakes, ScansOfARobotThatSaysItHasNoLaser) {
  Server server;
  server.take(scan(), 5, DropReason::no_laser);
  ASSERT_EQ(server.told().size(), 1U);
  EXPECT_TRUE(server.told()[0].starts_with("scans_without_laser R1: ")) << server.told()[0];
}

TEST(Mistakes, StampsInAnotherUnit) {
  for (const auto& [utime, unit] : {std::pair(now_utime * 1000, "nanoseconds"),
                                    {now_utime / 1000, "milliseconds"},
                                    {now_utime / 1'000'000, "seconds"}}) {
    Server server;
    server.take(scan(utime), 5, utime > now_utime ? DropReason::absurd_value : DropReason::none);
    EXPECT_EQ(server.told(), Lines{"wrong_time_unit R1: R1's stamps seem to be in " + std::string(unit) +
                                   ": they must be in microseconds"});
  }
}

TEST(Mistakes, StampsOfARightOrUnknownClockAreNone) {
  Server server;
  server.take(scan(now_utime - 600'000'000), 9);
  server.take(scan(5), 9);  // since the robot was switched on
  EXPECT_EQ(server.told(), Lines{});
}

TEST(Mistakes, ANameThatDiffersFromItsChannelAndNoOther) {
  Server server;
  Message message = encode(introduction(false));
  message.channel = "R2_ROBOT";
  for (int i = 0; i < 2; ++i)
    server.mistakes.note(*find_channel({}, message.channel), message.bytes, DropReason::bad_name, now_utime);
  Message other = encode(scan());
  for (int i = 0; i < 9; ++i)
    server.mistakes.note(*find_channel({}, "R2_SCAN"), other.bytes, DropReason::unknown_robot, now_utime);
  EXPECT_EQ(server.told(),
            Lines{"name_differs R2: R2_ROBOT says that it is 'R1': name and channel must be the same"});
}

TEST(Mistakes, RestartedInEveryMessageAndNotInOne) {
  Server server;
  server.take(introduction(true), 2);
  server.take(introduction(false), 1);
  server.take(introduction(true), 2);
  EXPECT_EQ(server.told(), Lines{});
  server.take(introduction(true), 1);
  ASSERT_EQ(server.told().size(), 1U);
  EXPECT_TRUE(server.told()[0].starts_with("always_restarted R1: ")) << server.told()[0];
}

TEST(Mistakes, ABarcodeThatNobodyWears) {
  Server server;
  server.take({now_utime, SightingEvent{"R1", now_utime, 77, 2, 0.1, 0, 0.1}}, 5,
              DropReason::unknown_barcode);
  EXPECT_EQ(
      server.told(),
      Lines{"barcode_of_nobody R1: R1 sees barcode 77, which no robot wears and no ISTHMUS_TAG declares"});
}

TEST(Mistakes, MissingAndUselessSignatures) {
  Server server;
  for (int i = 0; i < 5; ++i) {
    server.mistakes.note_refused("R1", DropReason::not_signed);
    server.mistakes.note_refused("", DropReason::no_keys);
    server.mistakes.note_refused("R1", DropReason::forged);
  }
  ASSERT_EQ(server.told().size(), 2U);
  EXPECT_TRUE(server.told()[0].starts_with("signed_without_keys : ")) << server.told()[0];
  EXPECT_TRUE(server.told()[1].starts_with("unsigned R1: ")) << server.told()[1];
}

TEST(Mistakes, ThatAreNoMessagesAreNotRead) {
  Server server;
  for (int i = 0; i < 9; ++i) {
    server.mistakes.note(*find_channel({}, "R1_SCAN"), {}, DropReason::bad_length, now_utime);
    server.mistakes.note(*find_channel({}, "R1_ROBOT"), {}, DropReason::bad_fingerprint, now_utime);
    server.mistakes.note(*find_channel({}, "ISTHMUS_TAG"), {}, DropReason::absurd_value, now_utime);
  }
  EXPECT_EQ(server.told(),
            Lines{"another_type R1: R1_ROBOT is no isthmus.robot_t, by its fingerprint, and is refused"});
}

TEST(Mistakes, AnIntroductionThatIsRefusedIsToldWithWhyAndNotAsIfNoneHadCome) {
  Server server;
  server.take(introduction(false), 1, DropReason::barcode_taken);
  server.take(scan(), 9, DropReason::unknown_robot);
  EXPECT_EQ(server.told(),
            Lines{"introduction_refused R1: R1_ROBOT is refused, and all that it sends with it: "
                  "another robot wears barcode -1 (barcode_taken)"});
  server.take(introduction(false), 1);
  EXPECT_EQ(server.told().size(), 1U);
  EXPECT_TRUE(server.told()[0].starts_with("not_introduced")) << "until the next scans are taken";
}

TEST(Mistakes, AnIntroductionThatIsRefusedForItsTimeUnitIsOneMistake) {
  Server server;
  RobotEvent robot;
  robot.robot = "R1";
  robot.utime = now_utime * 1000;
  server.take({now_utime, robot}, 1, DropReason::absurd_value);
  server.take(scan(), 9, DropReason::unknown_robot);
  EXPECT_EQ(server.told(),
            Lines{"wrong_time_unit R1: R1's stamps seem to be in nanoseconds: they must be in microseconds"});
}

TEST(Mistakes, ScansOfAnotherTypeAreToldWithTheTypeThatTheyMustBe) {
  Server server;
  server.take(scan(), 5, DropReason::bad_fingerprint);
  EXPECT_EQ(
      server.told(),
      Lines{"another_type R1: R1_SCAN is no bot_core.planar_lidar_t, by its fingerprint, and is refused"});
}

TEST(Mistakes, AreABoundedNumber) {
  Server server;
  for (int i = 0; i < 1000; ++i) {
    const Channel channel{Input::scan, "X" + std::to_string(i), true};
    for (int k = 0; k < 5; ++k) server.mistakes.note(channel, {}, DropReason::unknown_robot, 0);
  }
  EXPECT_EQ(server.told().size(), 64U);
}

}  // namespace
}  // namespace isthmus
