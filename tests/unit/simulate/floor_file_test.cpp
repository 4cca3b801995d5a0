#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/support/temporary_directory.hpp"
#include "tools/simulate/scenario/scenario_file.hpp"

namespace isthmus {
namespace {

std::string error_of_floor(const std::vector<std::string>& overrides) {
  const std::string error = error_of([&] { load_scenario("floor", overrides); });
  const std::size_t file = error.rfind("floor.toml:");
  return file == std::string::npos ? error : error.substr(file);
}

double length_of(const RobotPlan& robot) {
  double length_m = 0;
  Eigen::Vector2d at(robot.start.x, robot.start.y);
  for (const TourStep& step : robot.tour) {
    const auto* waypoint = std::get_if<Waypoint>(&step);
    if (waypoint == nullptr) continue;
    length_m += (waypoint->position - at).norm();
    at = waypoint->position;
  }
  return length_m;
}

TEST(FloorFile, AreaSeedAndRobotsAreAsAskedFor) {
  const Scenario scenario = load_scenario("floor", {"floor.area_m2=6000", "floor.seed=7", "floor.robots=6"});
  const Eigen::Vector2d size = scenario.plan.high - scenario.plan.low;
  EXPECT_NEAR(size.prod(), 6000, 50);
  ASSERT_EQ(scenario.robots.size(), 6U);
  std::set<int> barcodes;
  std::set<std::string> names;
  for (const RobotPlan& robot : scenario.robots) {
    barcodes.insert(robot.barcode);
    names.insert(robot.name);
    EXPECT_GT(length_of(robot), 300);
  }
  EXPECT_EQ(barcodes.size(), 6U);
  EXPECT_EQ(names, (std::set<std::string>{"R1", "R2", "R3", "R4", "R5", "R6"}));
}

TEST(FloorFile, SeedDecidesTheFloorAndNothingElseDoes) {
  const auto plan = [](const std::string& setting) { return load_scenario("floor", {setting}).plan; };
  const FloorPlan one = plan("floor.seed=1"), same = plan("laser.rate_hz=1"), other = plan("floor.seed=2");
  ASSERT_EQ(one.segments.size(), same.segments.size());
  for (std::size_t i = 0; i < one.segments.size(); ++i) EXPECT_EQ(one.segments[i].a, same.segments[i].a);
  EXPECT_GT((one.high - other.high).norm(), 0.1);
}

TEST(FloorFile, ToursAreAboutAsLongAsAskedFor) {
  for (const RobotPlan& robot : load_scenario("floor", {"floor.tour_m=400"}).robots) {
    EXPECT_GT(length_of(robot), 380);
    EXPECT_LT(length_of(robot), 550);
  }
}

TEST(FloorFile, RobotsStartInDifferentRooms) {
  const Scenario scenario = load_scenario("floor", {"floor.robots=8"});
  for (const RobotPlan& a : scenario.robots) {
    for (const RobotPlan& b : scenario.robots) {
      if (a.name == b.name) continue;
      EXPECT_GT(std::hypot(a.start.x - b.start.x, a.start.y - b.start.y), 0.8);
    }
  }
}

TEST(FloorFile, SettingsOfOneRobotLieOverThoseMade) {
  const Scenario scenario = load_scenario("floor", {"robots.R2.camera.rate_hz=0", "robots.R2.barcode=-1"});
  EXPECT_EQ(scenario.robots.at(1).camera.rate_hz, 0);
  EXPECT_EQ(scenario.robots.at(1).barcode, -1);
  EXPECT_GT(scenario.robots.at(1).tour.size(), 10U);
  EXPECT_EQ(scenario.robots.at(0).camera.rate_hz, 2);
}

TEST(FloorFile, CorridorsAreAsWideAsAskedFor) {
  EXPECT_NO_THROW(load_scenario("floor", {"floor.corridor_m=3.5", "floor.corridors=ring"}));
  EXPECT_NO_THROW(load_scenario("floor", {"floor.room_m=9", "floor.corridors=spine", "floor.furniture=0"}));
}

TEST(FloorFile, MistakesAreNamed) {
  EXPECT_EQ(error_of_floor({"floor.corridors=round"}),
            "floor.toml:5: 'corridors' must be \"any\", \"ring\" or \"spine\"");
  EXPECT_EQ(error_of_floor({"floor.area_m2=20"}),
            "--set floor.area_m2=20: area_m2 = 20 is not within 100 to 100000");
  EXPECT_EQ(error_of_floor({"laps=2"}), "floor.toml:5: a floor's tours are driven once: laps must be 1");
  EXPECT_EQ(error_of_floor({"robots.R9.barcode=3"}),
            "--set robots.R9.barcode=3: the floor has no robot 'R9'");
  EXPECT_EQ(error_of_floor({"building.walls=[]"}),
            "floor.toml:5: a scenario has a floor or a building, not both");
  EXPECT_NE(error_of_floor({"floor.robots=500"}).find("rooms to start in, for 500 robots"),
            std::string::npos);
}

}  // namespace
}  // namespace isthmus
