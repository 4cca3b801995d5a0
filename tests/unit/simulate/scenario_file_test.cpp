#include "tools/simulate/scenario/scenario_file.hpp"

#include <gtest/gtest.h>

#include "server/program/command_line.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tools/simulate/scenario/scenario_settings.hpp"

namespace isthmus {
namespace {

constexpr const char* small_scenario = R"(summary = "a room"
[building]
walls = [{corners = [[0, 0], [10, 0], [10, 6], [0, 6]], closed = true}]
[robots.r1]
start = [2, 3, 90]
tour = [[8, 3], {wait_s = 5}, {carry_to = [2, 2, 0], carry_s = 7, odometry_restarts = false}, [8, 2]]
)";

std::string error_with(const std::string& text, const std::vector<std::string>& overrides = {}) {
  const TemporaryDirectory directory;
  const std::string file = directory.write("room.toml", text);
  const std::string error = error_of([&] { load_scenario(file, overrides); });
  return error.starts_with(file) ? error.substr(file.size()) : error;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

TEST(ScenarioFile, ReadsRobotsAndTheirTours) {
  const TemporaryDirectory directory;
  const Scenario scenario = load_scenario(directory.write("room.toml", small_scenario));
  EXPECT_EQ(scenario.name, "room");
  EXPECT_EQ(scenario.summary, "a room");
  ASSERT_EQ(scenario.robots.size(), 1U);
  const RobotPlan& robot = scenario.robots[0];
  EXPECT_EQ(robot.name, "R1");
  EXPECT_NEAR(robot.start.yaw, std::numbers::pi / 2, 1e-12);
  ASSERT_EQ(robot.tour.size(), 4U);
  EXPECT_EQ(std::get<Waypoint>(robot.tour[0]).position, Eigen::Vector2d(8, 3));
  EXPECT_NEAR(std::get<Waypoint>(robot.tour[0]).clearance_m, 1.94, 1e-9);
  EXPECT_EQ(std::get<Wait>(robot.tour[1]).seconds, 5);
  EXPECT_EQ(std::get<Carry>(robot.tour[2]).seconds, 7);
  EXPECT_FALSE(std::get<Carry>(robot.tour[2]).odometry_restarts);
}

TEST(ScenarioFile, EveryScenarioThatComesWithIsthmusLoads) {
  const auto scenarios = list_scenarios();
  EXPECT_GE(scenarios.size(), 10U);
  for (const auto& scenario : scenarios) {
    EXPECT_NO_THROW(load_scenario(scenario.name)) << scenario.name;
    EXPECT_FALSE(scenario.summary.empty()) << scenario.name;
  }
}

TEST(ScenarioFile, OverridesLieOverTheFile) {
  const Scenario scenario = load_scenario(
      "loop", {"laps=7", "laser.range_sigma_m=0.5", "robots.R1.odometry.rate_hz=11", "summary=other"});
  EXPECT_EQ(scenario.robots.at(0).laps, 7);
  EXPECT_EQ(scenario.robots.at(0).laser.range_sigma_m, 0.5);
  EXPECT_EQ(scenario.robots.at(0).odometry.rate_hz, 11);
  EXPECT_EQ(scenario.summary, "other");
}

TEST(ScenarioFile, RobotsOwnSettingsLieOverThoseOfAll) {
  const TemporaryDirectory directory;
  const Scenario scenario =
      load_scenario(directory.write("room.toml", std::string("laser = {beams = 11, rate_hz = 3}\n") +
                                                     small_scenario + "laser = {beams = 21}\n"));
  EXPECT_EQ(scenario.robots[0].laser.beams, 21);
  EXPECT_EQ(scenario.robots[0].laser.rate_hz, 3);
}

TEST(ScenarioFile, ErrorsNameFileLineAndReason) {
  EXPECT_EQ(error_with(replaced(small_scenario, "summary", "sumary")).substr(0, 30),
            ":1: unknown key 'sumary'; did ");
  EXPECT_EQ(error_with(replaced(small_scenario, "wait_s", "wait")), ":6: 'carry_to' is missing");
  EXPECT_EQ(error_with(replaced(small_scenario, "[2, 3, 90]", "[2, 3]")),
            ":5: expected [x, y, yaw] in metres and degrees");
  EXPECT_EQ(error_with(replaced(small_scenario, "[2, 3, 90]", "[2, nan, 0]")),
            ":5: expected [x, y, yaw] in metres and degrees");
  EXPECT_EQ(error_with(replaced(small_scenario, "\"a room\"", "3")), ":1: summary must be a string");
  EXPECT_EQ(error_with("building = {walls = []}\n[laser]\nrange_sigma_m = -1\n[robots.r1]\nstart = [0, 0, "
                       "0]\ntour = []\n"),
            ":3: range_sigma_m = -1 is not within 0 to 10");
  EXPECT_EQ(error_with("building = {walls = []}\n").substr(0, 3), ":1:");
  EXPECT_EQ(error_with("tour = [[1,").substr(0, 3), ":1:");
  EXPECT_EQ(error_with(small_scenario, {"laps"}), "--set laps: expected key=value");
  EXPECT_EQ(error_with(small_scenario, {"lap=2"}).substr(0, 32), "--set lap=2: unknown key 'lap'; ");
  EXPECT_EQ(error_with(small_scenario, {"laps=1.5"}), "--set laps=1.5: laps must be an integer");
  EXPECT_EQ(error_with(small_scenario, {"summary=it's"}).substr(0, 20), "--set summary=it's: ");
}

TEST(ScenarioFile, RefusesATourThroughAWall) {
  const std::string error = error_with(replaced(small_scenario, "[[8, 3]", "[[12, 3]"));
  EXPECT_EQ(error.substr(0, 4), ":6: ");
  EXPECT_NE(error.find("comes within 0 m of a wall"), std::string::npos) << error;
}

TEST(ScenarioFile, RefusesATourThatGrazesAWall) {
  EXPECT_NE(error_with(replaced(small_scenario, "[[8, 3]", "[[8, 5.8]")).find("of a wall"),
            std::string::npos);
}

TEST(ScenarioFile, NamesWhatIsMissing) {
  EXPECT_EQ(error_of([] { load_scenario("no_such_scenario"); }),
            "no scenario is called 'no_such_scenario'; isthmus-simulate --list names them");
  EXPECT_THROW(load_scenario("no_such_scenario"), UsageError);
  EXPECT_EQ(error_of([] { load_scenario("./no_such_file.toml"); }), "./no_such_file.toml: cannot be read");
}

TEST(ScenarioFile, BuildingsFileIsNamedInItsErrors) {
  const TemporaryDirectory directory;
  directory.write("house.toml", "\nwalls = 3\n");
  const std::string file = directory.write(
      "room.toml", "building = \"house.toml\"\n[robots.r1]\nstart = [0, 0, 0]\ntour = [[1, 0]]\n");
  EXPECT_EQ(error_of([&] { load_scenario(file); }), directory / "house.toml:2: expected a list of walls");
}

TEST(ScenarioFile, ClutterStaysOffTheWays) {
  const TemporaryDirectory directory;
  const std::string text =
      replaced(small_scenario, "walls =", "clutter = {count = 40, clearance_m = 0.6}\nwalls =");
  const Scenario cluttered = load_scenario(directory.write("room.toml", text));
  const Scenario bare = load_scenario(directory.write("bare.toml", small_scenario));
  EXPECT_GT(cluttered.plan.segments.size(), bare.plan.segments.size() + 20 * 4);
  EXPECT_GE(clearance_m(cluttered.plan, {2, 3}, {8, 3}), 0.6);
}

}  // namespace
}  // namespace isthmus
