#include "tools/import/carmen_line.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace isthmus {
namespace {

CarmenLine parsed(const std::string& text) {
  ParsedCarmenLine line = parse_carmen_line(text);
  if (const auto* error = std::get_if<std::string>(&line)) ADD_FAILURE() << *error;
  return std::holds_alternative<CarmenLine>(line) ? std::get<CarmenLine>(line) : CarmenLine{};
}

std::string error(const std::string& text) {
  const ParsedCarmenLine line = parse_carmen_line(text);
  const auto* reason = std::get_if<std::string>(&line);
  return reason == nullptr ? "" : *reason;
}

std::string front_laser(int n) {
  std::string text = "FLASER " + std::to_string(n);
  for (int i = 0; i < n; ++i) text += " 1.5";
  return text + " 9 9 9 1 2 0.5 10.000001 host 77.7";
}

TEST(CarmenLine, OdometryHasPoseAndMessageStamp) {
  const CarmenLine line = parsed("ODOM 1.5 -2 0.25 0.1 0.2 0 976052857.337284 host 12.5");
  EXPECT_EQ(line.odom_from_robot, (Pose{1.5, -2, 0.25}));
  EXPECT_EQ(line.utime, 976052857337284);
  EXPECT_FALSE(line.laser);
}

TEST(CarmenLine, AFrontLasersSecondPoseIsTheOdometry) {
  const CarmenLine line = parsed(front_laser(180));
  EXPECT_EQ(line.odom_from_robot, (Pose{1, 2, 0.5}));
  EXPECT_EQ(line.utime, 10000001);
  ASSERT_TRUE(line.laser);
  EXPECT_EQ(line.laser->scan.utime, line.utime);
  EXPECT_EQ(line.laser->scan.ranges_m, std::vector<float>(180, 1.5F));
  EXPECT_FALSE(line.laser->robot_from_laser);
}

TEST(CarmenLine, AnEvenFrontLaserStepsByItsCountAnOddOneByOneLess) {
  const double degree = std::numbers::pi / 180;
  for (const auto& [n, step] :
       {std::pair{180, degree}, {360, degree / 2}, {181, degree}, {361, degree / 2}}) {
    const Scan scan = parsed(front_laser(n)).laser->scan;
    EXPECT_DOUBLE_EQ(scan.bearing0_rad, -90 * degree) << n;
    EXPECT_DOUBLE_EQ(scan.bearing_step_rad, step) << n;
  }
}

TEST(CarmenLine, AFrontLaserMayHaveNoOrOneBeam) {
  EXPECT_TRUE(parsed(front_laser(0)).laser->scan.ranges_m.empty());
  EXPECT_EQ(parsed(front_laser(1)).laser->scan.ranges_m.size(), 1U);
}

TEST(CarmenLine, ALaserHasNoMoreBeamsThanAMessageMayHold) {
  EXPECT_EQ(parsed(front_laser(20'000)).laser->scan.ranges_m.size(), 20'000U);
  EXPECT_EQ(error(front_laser(20'001)),
            "field 2 of FLASER counts more beams than the 20000 of a message: '20001'");
}

const std::string robot_laser =
    "ROBOTLASER1 0 -1.5 3 0.01 30 0.01 0 3 1 2 inf 2 7 8 1.2 2.3 0.6 1 2 0.5 0.1 0.2 0.3 0.3 0.4 5.25 host "
    "5.3";

TEST(CarmenLine, ARobotLaserTellsItsAnglesMountAndMaximumRange) {
  const CarmenLine line = parsed(robot_laser);
  ASSERT_TRUE(line.laser);
  EXPECT_EQ(line.utime, 5250000);
  EXPECT_EQ(line.odom_from_robot, (Pose{1, 2, 0.5}));
  EXPECT_EQ(line.laser->scan.bearing0_rad, -1.5);
  EXPECT_EQ(line.laser->scan.bearing_step_rad, 0.01);
  EXPECT_EQ(line.laser->scan.ranges_m.size(), 3U);
  EXPECT_EQ(line.laser->range_max_m, 30);
  const Pose mount = *line.laser->robot_from_laser;
  const Pose odom_from_laser = line.odom_from_robot * mount;
  EXPECT_NEAR(odom_from_laser.x, 1.2, 1e-12);
  EXPECT_NEAR(odom_from_laser.y, 2.3, 1e-12);
  EXPECT_NEAR(mount.yaw, 0.1, 1e-12);
}

TEST(CarmenLine, OtherMessagesAndCommentsArePassedOver) {
  for (const char* text :
       {"", "   ", "# a comment", "PARAM robot_width 0.5", "SYNC x", "RLASER 1 2", "NMEAGGA 1"}) {
    EXPECT_TRUE(std::holds_alternative<CarmenOther>(parse_carmen_line(text))) << text;
  }
}

TEST(CarmenLine, AnUnknownMessageTypeIsNamed) {
  EXPECT_EQ(error("FLASR 1 2 3"), "unknown message type 'FLASR'");
  EXPECT_EQ(error("\x01"
                  "E\x7f 1"),
            "unknown message type '?E?'");
}

TEST(CarmenLine, AWrongCountOfFieldsIsAnError) {
  EXPECT_EQ(error("ODOM 1 2 3 4 5 6 7 host"), "wrong count of fields in ODOM: 9 instead of 10");
  EXPECT_EQ(error("FLASER 2 1.5 1 2 3 1 2 3 4 host 5"), "wrong count of fields in FLASER: 12 instead of 13");
  EXPECT_EQ(error("FLASER 99999999999 1"),
            "field 2 of FLASER counts more values than the line has: '99999999999'");
  EXPECT_EQ(error("FLASER"), "wrong count of fields in FLASER: the line ends early");
  EXPECT_EQ(error(robot_laser + " 1"), "wrong count of fields in ROBOTLASER1: 30 instead of 29");
  EXPECT_NE(error(robot_laser.substr(0, robot_laser.size() - 9)), "");
}

TEST(CarmenLine, ANonNumberIsNamedWithItsField) {
  EXPECT_EQ(error("ODOM 1 x 3 4 5 6 7 host 8"), "field 3 of ODOM is not a finite number: 'x'");
  EXPECT_EQ(error("ODOM 1 nan 3 4 5 6 7 host 8"), "field 3 of ODOM is not a finite number: 'nan'");
  EXPECT_EQ(error("ODOM 1 2 3 4 5 6 soon host 8"), "field 8 of ODOM is not a time in seconds: 'soon'");
  EXPECT_EQ(error("FLASER -1 1 2 3 1 2 3 4 host 5"), "field 2 of FLASER is not a count: '-1'");
  EXPECT_EQ(error("FLASER 1 1.2.3 1 2 3 1 2 3 4 host 5"), "field 3 of FLASER is not a number: '1.2.3'");
}

}  // namespace
}  // namespace isthmus
