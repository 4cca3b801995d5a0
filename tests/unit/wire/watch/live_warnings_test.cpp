#include "server/wire/watch/live_warnings.hpp"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

TEST(LiveWarnings, TellsOfEachOnceWhenItBeginsAndOnceWhenItEnds) {
  std::vector<std::string> lines;
  const Log log = [&](LogLevel level, std::string_view text, const LogFields& fields) {
    lines.push_back(log_line(0, level, text, fields).substr(30));
  };
  LiveWarnings warnings;
  const LiveWarning few{"few_matches", "R1", "40 % of R1's scans could be matched", 0};
  const LiveWarning fewer{"few_matches", "R1", "30 % of R1's scans could be matched", 0};
  const LiveWarning other{"other_server", "", "another server sends", 0};
  warnings.update({few}, 1'000'000, log);
  warnings.update({other, fewer}, 2'000'000, log);
  warnings.update({other, fewer}, 3'000'000, log);
  warnings.update({other}, 9'000'000, log);
  EXPECT_EQ(lines,
            (std::vector<std::string>{
                "level=warning msg=\"40 % of R1's scans could be matched\" warning=few_matches robot=R1",
                "level=warning msg=\"another server sends\" warning=other_server",
                "level=info msg=\"no longer: 30 % of R1's scans could be matched\" warning=few_matches "
                "robot=R1 seconds=8"}));
  ASSERT_EQ(warnings.current().size(), 1U);
  EXPECT_EQ(warnings.current()[0].begin_utime, 2'000'000);
}

TEST(LiveWarnings, TheSameOfTwoRobotsAreTwo) {
  LiveWarnings warnings;
  warnings.update({{"no_scans", "R2", "", 0}, {"no_scans", "R1", "", 0}}, 1, {});
  ASSERT_EQ(warnings.current().size(), 2U);
  EXPECT_EQ(warnings.current()[0].robot, "R1");
}

TEST(LiveWarnings, HealthIsThatOfTheReport) {
  MapCopy map;
  HealthRecord robot;
  robot.robot = "R1";
  robot.warnings = {{"clock_ahead", "R1's clock is ahead"}};
  map.health = {robot};
  const auto warnings = health_warnings_of(map);
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0].kind, "clock_ahead");
  EXPECT_EQ(warnings[0].robot, "R1");
  EXPECT_EQ(warning_message(warnings[0]).text, "R1's clock is ahead");
}

TEST(LiveWarnings, SayWhereTheMapContradictsItselfMost) {
  EXPECT_TRUE(warnings_of_contradictions({}).empty());
  const SelfContradiction most{PatchId{3}, {1.24, -2}, {PatchId{3}, PatchId{9}}, {"R1"}, 20};
  const auto one = warnings_of_contradictions({most});
  ASSERT_EQ(one.size(), 1U);
  EXPECT_EQ(one[0].kind, "map_contradicts_itself");
  EXPECT_EQ(one[0].robot, "");
  EXPECT_EQ(one[0].text,
            "the map contradicts itself around x 1.2 m, y -2.0 m of island 3: a place may be on it twice");
  const auto two = warnings_of_contradictions({most, most});
  ASSERT_EQ(two.size(), 1U);
  EXPECT_NE(two[0].text.find("and at 1 more"), std::string::npos) << two[0].text;
}

TEST(LiveWarnings, SayWhyARobotIsNotFound) {
  const auto warnings =
      warnings_of_lost({{"R1", NotFound::way_too_short, 1.23, 2}, {"R2", NotFound::ambiguous}});
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_EQ(warnings[0].kind, "not_found");
  EXPECT_EQ(warnings[0].text,
            "R1 is not found on the map: it has driven 1.2 m of the 2.0 m that a search takes");
  EXPECT_EQ(warnings[1].text, "R2 is not found on the map: what it sees on its way fits two places");
}

}  // namespace
}  // namespace isthmus
