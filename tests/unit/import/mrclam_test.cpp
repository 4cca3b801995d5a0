#include "tools/import/mrclam.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cmath>
#include <numbers>
#include <sstream>

#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

constexpr double pi = std::numbers::pi;

/// Robots 1 and 3 with landmarks 6 and 7.
void write_set(const TemporaryDirectory& set) {
  set.write("Barcodes.dat", "# Subject #    Barcode #\n  1 \t   5\n  3 \t  41\n  6 \t  63\n  7 \t  81\n");
  set.write("Landmark_Groundtruth.dat", "# a comment\n  6 \t 0.5 \t -4.25 \t 0.1 \t 0.2\n 7 1 2 0.1 0.1\n");
  set.write("Robot1_Odometry.dat", "# Time v w\n1000.000 \t 0.5 \t 0.0\n1001.000 \t 0.0 \t 0.5\n");
  set.write("Robot1_Measurement.dat", "1000.500 \t 63 \t 2.0 \t -0.25\n1000.600 43 1 0\n");
  set.write("Robot1_Groundtruth.dat", "999.5 1.25 -2 3.5\n1000.5 1.5 -2 0\n");
  set.write("Robot3_Odometry.dat", "1000.100 0 0\n");
  set.write("Robot3_Measurement.dat", "1000.100 5 1.5 0.125\n");
  set.write("Robot3_Groundtruth.dat", "1000 0 0 0\n");
}

/// Without lags, so that stamps are those of the files.
MrclamImport import_of(const TemporaryDirectory& set) {
  MrclamImport what;
  what.directory = set / "";
  what.odometry_lag_s = what.sighting_lag_s = 0;
  return what;
}

template <class Body>
std::vector<Body> all_of(const std::vector<Event>& events) {
  std::vector<Body> bodies;
  for (const Event& event : events) {
    if (const auto* body = std::get_if<Body>(&event.body)) bodies.push_back(*body);
  }
  return bodies;
}

/// "R1 T63 O1@1000.2" in the order of events, with receive times in tenths of a second.
std::string names_and_times(const std::vector<Event>& events) {
  std::ostringstream text;
  for (const Event& event : events) {
    if (const auto* e = std::get_if<RobotEvent>(&event.body)) text << e->robot;
    if (const auto* e = std::get_if<TagEvent>(&event.body)) text << "T" << e->barcode;
    if (const auto* e = std::get_if<OdometryEvent>(&event.body)) text << "O" << e->robot;
    if (const auto* e = std::get_if<SightingEvent>(&event.body)) text << "S" << e->robot;
    text << "@" << event.receive_utime / 100000 << " ";
  }
  return text.str();
}

void expect_pose(const Pose& found, const Pose& expected, double tolerance = 1e-12) {
  EXPECT_NEAR(found.x, expected.x, tolerance);
  EXPECT_NEAR(found.y, expected.y, tolerance);
  EXPECT_NEAR(wrap_angle(found.yaw - expected.yaw), 0, tolerance);
}

TEST(MrclamOdometry, IsAnArcOfACircle) {
  // A quarter of a circle of radius 2 m to the left, then straight on.
  const double turn = pi / 4;
  const std::vector<VelocityLine> lines = {{0, 2 * turn, turn}, {2'000'000, 1, 0}, {3'000'000, 0, 0}};
  const auto poses = integrate_velocities(lines, 10);
  ASSERT_EQ(poses.size(), 3U);
  expect_pose(poses[0], {0, 0, 0});
  expect_pose(poses[1], {2, 2, pi / 2});
  expect_pose(poses[2], {2, 3, pi / 2});
}

TEST(MrclamOdometry, DoesNotDependOnHowOftenAVelocityIsRepeated) {
  for (const double turn : {0.0, 1e-7, 1e-4, 0.4, -2.5}) {
    const std::vector<VelocityLine> once = {{0, 0.3, turn}, {1'000'000, 0, 0}};
    std::vector<VelocityLine> often;
    for (int i = 0; i < 100; ++i) often.push_back({i * 10'000, 0.3, turn});
    often.push_back({1'000'000, 0, 0});
    expect_pose(integrate_velocities(often, 10).back(), integrate_velocities(once, 10).back());
  }
}

TEST(MrclamOdometry, AGapHoldsTheLastCommandNoLongerThanTheLimit) {
  const std::vector<VelocityLine> lines = {{0, 0.5, 0}, {60'000'000, 0.5, 0}, {60'500'000, 0, 0}};
  const auto poses = integrate_velocities(lines, 1.5);
  EXPECT_NEAR(poses[1].x, 0.75, 1e-12);
  EXPECT_NEAR(poses[2].x, 1.0, 1e-12);
}

TEST(MrclamOdometry, AStampThatRunsBackMovesNothing) {
  const std::vector<VelocityLine> lines = {{1'000'000, 0.5, 0}, {0, 0.25, 0}, {1'000'000, 0, 0}};
  const auto poses = integrate_velocities(lines, 10);
  EXPECT_EQ(poses[1].x, 0);
  EXPECT_NEAR(poses[2].x, 0.25, 1e-12);
}

TEST(Mrclam, RobotsAndTagsComeFirstAndTheRestMergedByTime) {
  const TemporaryDirectory set;
  write_set(set);
  EXPECT_EQ(names_and_times(import_mrclam(import_of(set))),
            "R1@10000 R3@10000 T63@10000 T81@10000 OR1@10000 OR3@10001 SR3@10001 SR1@10005 SR1@10006 "
            "OR1@10010 ");
}

TEST(Mrclam, RobotsWearTheirBarcodesAndHaveNoLaser) {
  const TemporaryDirectory set;
  write_set(set);
  const auto robots = all_of<RobotEvent>(import_mrclam(import_of(set)));
  ASSERT_EQ(robots.size(), 2U);
  EXPECT_EQ(robots[0].barcode, 5);
  EXPECT_EQ(robots[1].barcode, 41);
  for (const RobotEvent& robot : robots) EXPECT_EQ(robot.laser.range_max_m, 0);
}

TEST(Mrclam, SightingsHaveSigmasThatGrowWithRangeAndUnknownBarcodesStayIn) {
  const TemporaryDirectory set;
  write_set(set);
  MrclamImport what = import_of(set);
  what.range_std_m = 0.3;
  what.range_std_share = 0.2;
  what.bearing_std_rad = 0.05;
  const auto sightings = all_of<SightingEvent>(import_mrclam(what));
  ASSERT_EQ(sightings.size(), 3U);
  EXPECT_EQ(sightings[1].robot, "R1");
  EXPECT_EQ(sightings[1].utime, 1'000'500'000);
  EXPECT_EQ(sightings[1].barcode, 63);
  EXPECT_EQ(sightings[1].range_m, 2);
  EXPECT_EQ(sightings[1].bearing_rad, -0.25);
  EXPECT_NEAR(sightings[1].range_sigma_m, 0.5, 1e-12);
  EXPECT_EQ(sightings[1].bearing_sigma_rad, 0.05);
  EXPECT_EQ(sightings[2].barcode, 43);
}

TEST(Mrclam, RobotsSightingsOfOneAnotherMayBeLeftOut) {
  const TemporaryDirectory set;
  write_set(set);
  MrclamImport what = import_of(set);
  what.robot_sightings = false;
  std::vector<Event> events;
  const ImportReport report = import_mrclam(what, [&](const Event& event) { events.push_back(event); });
  std::vector<std::int32_t> seen;
  for (const SightingEvent& sighting : all_of<SightingEvent>(events)) seen.push_back(sighting.barcode);
  EXPECT_EQ(seen, (std::vector<std::int32_t>{63, 43})) << "barcodes that nobody has stay in";
  EXPECT_EQ(report.sightings, 2);
  EXPECT_EQ(report.robots.size(), 2U);
}

TEST(Mrclam, LagsMoveStampsToWhenThingsHappened) {
  const TemporaryDirectory set;
  write_set(set);
  MrclamImport what = import_of(set);
  what.odometry_lag_s = 0.2;
  what.sighting_lag_s = 0.04;
  const auto events = import_mrclam(what);
  EXPECT_EQ(all_of<OdometryEvent>(events)[0].utime, 1'000'200'000);
  EXPECT_EQ(all_of<SightingEvent>(events)[0].utime, 1'000'060'000);
  EXPECT_EQ(events.front().receive_utime, 1'000'060'000) << "nothing comes before the robots";
}

TEST(Mrclam, ReadsPackedFiles) {
  const TemporaryDirectory set;
  write_set(set);
  std::filesystem::remove(set / "Robot3_Odometry.dat");
  const gzFile file = gzopen((set / "Robot3_Odometry.dat.gz").c_str(), "wb");
  gzputs(file, "1000.1 0 0\n1000.2 0 0\n");
  gzclose(file);
  EXPECT_EQ(all_of<OdometryEvent>(import_mrclam(import_of(set))).size(), 4U);
}

TEST(Mrclam, ErrorsNameFileLineAndReasonBeforeTheFirstEvent) {
  const auto error = [](const std::string& file, const std::string& text) {
    const TemporaryDirectory set;
    write_set(set);
    set.write(file, text);
    int events = 0;
    std::string message = error_of([&] { import_mrclam(import_of(set), [&](const Event&) { ++events; }); });
    EXPECT_EQ(events, 0);
    const std::size_t at = message.find(file);
    return at == std::string::npos ? "?" + message : message.substr(at + file.size());
  };
  EXPECT_EQ(error("Barcodes.dat", "1 5\n1 6\n"), ":2: subject 1 twice");
  EXPECT_EQ(error("Barcodes.dat", "1 5\n2 5\n"), ":2: barcode 5 twice");
  EXPECT_EQ(error("Barcodes.dat", "1 5\n6 7\n"), ": no barcode of subject 3");
  EXPECT_EQ(error("Robot3_Odometry.dat", "#\n1000 1\n"),
            ":2: wrong count of fields: expected 'time forward_velocity angular_velocity'");
  EXPECT_EQ(error("Robot3_Odometry.dat", "1000 1 x\n"), ":1: 'x' is not a believable number");
  EXPECT_EQ(error("Robot3_Odometry.dat", "1000 1 nan\n"), ":1: 'nan' is not a believable number");
  EXPECT_EQ(error("Robot3_Odometry.dat", "#\n"), ": no odometry in it");
  EXPECT_EQ(error("Robot1_Measurement.dat", "1000 63 1 0\nsoon 63 1 0\n"),
            ":2: 'soon' is not a time in seconds");
  EXPECT_EQ(error("Robot1_Measurement.dat", "1000 -63 1 0\n"), ":1: '-63' is not an integer from 0 on");
  EXPECT_EQ(error("Robot1_Measurement.dat", "1000 63 -1 0\n"), ":1: a negative range");
}

TEST(Mrclam, AMissingFileIsNamed) {
  const TemporaryDirectory set;
  EXPECT_NE(error_of([&] { import_mrclam(import_of(set)); }).find("no Barcodes.dat"), std::string::npos);
  set.write("Barcodes.dat", "1 5\n");
  EXPECT_NE(error_of([&] { import_mrclam(import_of(set)); }).find("not a MRCLAM set"), std::string::npos);
}

TEST(MrclamTruth, IsWrittenAsTheSimulatorsIs) {
  const TemporaryDirectory set;
  write_set(set);
  write_mrclam_truth(set / "", set / "truth");
  const auto content = [&](const std::string& name) {
    std::ifstream file(set / name);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
  };
  EXPECT_EQ(content("truth/tags.csv"), "barcode,x_m,y_m\n63,0.5,-4.25\n81,1,2\n");
  // 3.5 rad is 3.5 - 2 pi; half of it has the sine -0.983985947 and the cosine 0.178246056.
  EXPECT_EQ(content("truth/R1.tum"),
            "999.500000 1.250000 -2.000000 0 0 0 -0.983985947 0.178246056\n"
            "1000.500000 1.500000 -2.000000 0 0 0 0.000000000 1.000000000\n");
  EXPECT_TRUE(std::filesystem::exists(set / "truth/R3.tum"));
}

}  // namespace
}  // namespace isthmus
