#include "server/engine/input/configuration.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "server/engine/input/tuning.hpp"

namespace isthmus {
namespace {

Configuration parsed(const std::string& toml) {
  const auto result = parse_configuration(toml, "c.toml");
  if (const auto* error = std::get_if<std::string>(&result)) ADD_FAILURE() << *error;
  return std::holds_alternative<Configuration>(result) ? std::get<Configuration>(result) : Configuration{};
}

std::string error_in(const std::string& toml) {
  const auto result = parse_configuration(toml, "c.toml");
  const auto* error = std::get_if<std::string>(&result);
  return error ? *error : "";
}

std::string example() {
  std::ifstream file("server/isthmus.example.toml");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// The example with its keys (lines "#key ..." without a space) switched on.
std::string example_switched_on() {
  std::istringstream lines(example());
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    const bool is_key = line.size() > 1 && line[0] == '#' && line[1] != ' ';
    text += (is_key ? line.substr(1) : line) + "\n";
  }
  return text;
}

TEST(Configuration, NeedsNoKey) {
  const Configuration configuration = parsed("");
  EXPECT_FALSE(configuration.any_tag);
  EXPECT_TRUE(configuration.robots.empty());
}

TEST(Configuration, ExampleParsesAsItIsAndChangesNothing) {
  ASSERT_FALSE(example().empty());
  const Configuration configuration = parsed(example());
  EXPECT_TRUE(configuration.robots.empty());
  EXPECT_EQ(configuration.toml, example());
}

TEST(Configuration, ExampleShowsTheDefaults) {
  const Configuration shown = parsed(example_switched_on());
  const EngineOptions defaults;
  EXPECT_EQ(shown.any_tag, Configuration{}.any_tag);
  EXPECT_EQ(tuning_text(shown.engine), tuning_text({}));
  EXPECT_EQ(shown.engine.local_map.position_m, defaults.local_map.position_m);
  EXPECT_EQ(shown.engine.local_map.yaw_rad, defaults.local_map.yaw_rad);
  EXPECT_EQ(shown.engine.patch_spacing_m, defaults.patch_spacing_m);
  EXPECT_EQ(shown.engine.patch_spacing_rad, defaults.patch_spacing_rad);
  EXPECT_EQ(shown.engine.uncovered_share, defaults.uncovered_share);
  EXPECT_EQ(shown.engine.patches_per_robot, defaults.patches_per_robot);
  EXPECT_EQ(shown.engine.patch.free_space.max_range_m, defaults.patch.free_space.max_range_m);
  EXPECT_EQ(shown.engine.patch.free_space.no_return_range_m, defaults.patch.free_space.no_return_range_m);
  ASSERT_EQ(shown.robots.size(), 1U);
  const RobotConfiguration& robot = shown.robots.at("R1");
  const RobotEvent plain;
  EXPECT_EQ(robot.robot.barcode, plain.barcode);
  EXPECT_EQ(robot.robot.laser.robot_from_laser, plain.laser.robot_from_laser);
  EXPECT_EQ(robot.robot.laser.range_min_m, plain.laser.range_min_m);
  EXPECT_EQ(robot.robot.laser.range_max_m, plain.laser.range_max_m);
  EXPECT_EQ(robot.robot.footprint_radius_m, plain.footprint_radius_m);
  ASSERT_TRUE(robot.start);
  EXPECT_EQ(robot.start->sigma, MeasuredStart{}.sigma);
}

TEST(Configuration, ExampleShowsEveryKey) {
  const std::string text = example();
  for (const char* wrong :
       {"x_ = 1", "[engine]\nx_ = 1", "[robots.R1]\nx_ = 1", "[robots.R1]\nlaser = {x_ = 1}",
        "[robots.R1]\nstart = {with = \"R2\", x_ = 1}"}) {
    const std::string error = error_in(wrong);
    const std::size_t from = error.find("(known: ");
    ASSERT_NE(from, std::string::npos) << error;
    std::istringstream keys(error.substr(from + 8, error.size() - from - 9));
    for (std::string key; std::getline(keys >> std::ws, key, ',');) {
      const bool shown =
          text.find(key + " =") != std::string::npos || text.find("[" + key) != std::string::npos;
      EXPECT_TRUE(shown) << key;
    }
  }
}

TEST(Configuration, ReadsARobot) {
  const Configuration configuration = parsed(R"(
tags = "any"
[engine]
patch_spacing_m = 2
[limits]
patches_per_robot = 7
[robots.r1]
barcode = 5
laser = { x_m = 0.1, y_m = -0.2, yaw_rad = 3.1 }
range_max_m = 8
channels = { scan = "HOKUYO" }
start = { with = "r2", x = 1, yaw = 0.5, sigma_yaw = 0.1 }
[robots.R2]
channels = { odometry = "WHEELS" }
)");
  EXPECT_TRUE(configuration.any_tag);
  EXPECT_EQ(configuration.engine.patch_spacing_m, 2);
  EXPECT_EQ(configuration.engine.patches_per_robot, 7U);
  const RobotConfiguration& robot = configuration.robots.at("R1");
  EXPECT_TRUE(robot.declared);
  EXPECT_EQ(robot.robot.robot, "R1");
  EXPECT_EQ(robot.robot.barcode, 5);
  EXPECT_EQ(robot.robot.laser.robot_from_laser, (Pose{0.1, -0.2, 3.1}));
  EXPECT_EQ(robot.robot.laser.range_max_m, 8);
  ASSERT_TRUE(robot.start);
  EXPECT_EQ(robot.start->with, "R2");
  EXPECT_EQ(robot.start->with_from_robot, (Pose{1, 0, 0.5}));
  EXPECT_EQ(robot.start->sigma, Eigen::Vector3d(0.05, 0.05, 0.1));
  EXPECT_FALSE(configuration.robots.at("R2").declared) << "only its channels are known";
}

TEST(Configuration, AMaximumRangeOfZeroIsNoLaserWhateverTheMinimum) {
  for (const char* zero : {"0", "0.0"}) {
    const auto robots = parsed("[robots.R1]\nrange_min_m = 5\nrange_max_m = " + std::string(zero)).robots;
    EXPECT_TRUE(robots.at("R1").declared);
    EXPECT_EQ(robots.at("R1").robot.laser.range_max_m, 0);
  }
  EXPECT_EQ(error_in("[robots.R1]\nrange_max_m = 0.001"),
            "c.toml:2: range_max_m = 0.001 is not within 0.01 to 100000");
  EXPECT_EQ(error_in("[robots.R1]\nrange_max_m = -1"),
            "c.toml:2: range_max_m = -1 is not within 0.01 to 100000");
  EXPECT_EQ(error_in("[robots.R1]\nrange_max_m = false"), "c.toml:2: range_max_m must be a number");
}

TEST(Configuration, NamesFileLineAndReason) {
  EXPECT_EQ(error_in("\n[robots.R1]\nbarcod = 5").substr(0, 43),
            "c.toml:3: unknown key 'barcod' of robot R1;");
  EXPECT_EQ(error_in("tags = \"all\""), "c.toml:1: tags must be \"declared\" or \"any\"");
  EXPECT_EQ(error_in("tags = 5"), "c.toml:1: tags must be a string");
  EXPECT_EQ(error_in("[engine]\n\npatch_spacing_m = 0"),
            "c.toml:3: patch_spacing_m = 0 is not within 0.05 to 100");
  EXPECT_EQ(error_in("[limits]\npatches_per_robot = 0"),
            "c.toml:2: patches_per_robot = 0 is not within 1 to 10000000");
  EXPECT_EQ(error_in("[engine]\npatch_spacing_m = nan"),
            "c.toml:2: patch_spacing_m = nan is not within 0.05 to 100");
  EXPECT_EQ(error_in("engine = 5"), "c.toml:1: engine must be a table");
  EXPECT_EQ(error_in("[robots.R1]\nbarcode = 5.5"), "c.toml:2: barcode must be an integer");
  EXPECT_EQ(error_in("[robots.R1]\nbarcode = 99999999999"),
            "c.toml:2: barcode = 99999999999 is not within -1 to 2147483647");
  EXPECT_EQ(error_in("[robots.R1]\nrange_min_m = 5\nrange_max_m = 4"),
            "c.toml:1: range_min_m must be below range_max_m");
  EXPECT_EQ(error_in("[robots.R1]\nstart = {x = 1}"),
            "c.toml:2: start needs 'with', the robot it is measured from");
  EXPECT_EQ(error_in("[robots.R1]\nstart = {wiht = \"R2\"}").substr(0, 63),
            "c.toml:2: unknown key 'wiht' in start; did you mean 'with'? (kn");
  EXPECT_EQ(error_in("[robots.R1]\nstart = {with = \"r1\"}"), "c.toml:2: start.with must be another robot");
  EXPECT_EQ(error_in("[robots.R1]\n[robots.r1]"),
            "c.toml:2: robot R1 is given twice (names compare without case)");
  EXPECT_EQ(error_in("[robots.R1]\nbarcode = 5\n[robots.R2]\nbarcode = 5"),
            "c.toml:3: barcode 5 of robot R2 is given already to R1");
  EXPECT_EQ(error_in("[robots.\"../x\"]"),
            "c.toml:1: '../x' is no robot name: letters, digits, '_' and '-', at most 48");
  EXPECT_EQ(error_in("a = \n").substr(0, 10), "c.toml:1: ");
  EXPECT_EQ(error_in(std::string("tags = \"any\"\n\0", 14)).substr(0, 7), "c.toml:");
}

TEST(Configuration, FitsTheJournal) {
  const std::string longest = "#" + std::string(64 * 1024 - 2, 'x');
  EXPECT_EQ(error_in(longest), "");
  EXPECT_EQ(error_in(longest + "x"), "c.toml: longer than 65535 bytes");
}

}  // namespace
}  // namespace isthmus
