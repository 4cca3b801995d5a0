#include "tools/import/import.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_directory.hpp"
#include "tools/import/carmen_log.hpp"
#include "tools/text/lines.hpp"

namespace isthmus {
namespace {

std::string odometry(const std::string& stamp) {
  return "ODOM 0 0 0 0 0 0 " + stamp + " host " + stamp + "\n";
}

std::string laser(const std::string& stamp, const std::string& ranges = "1 2", int n = 2) {
  return "FLASER " + std::to_string(n) + " " + ranges + " 0 0 0 3 4 0.5 " + stamp + " host " + stamp + "\n";
}

/// "O1.5@2 S1.5@2": odometry and scan with stamp 1.5 s, received at 2 s.
std::string shape(const std::vector<Event>& events) {
  std::string text;
  const auto seconds = [](std::int64_t utime) { return std::to_string(utime / 100000); };
  for (const Event& event : events) {
    if (!text.empty()) text += ' ';
    if (const auto* e = std::get_if<RobotEvent>(&event.body)) text += "R:" + e->robot + seconds(e->utime);
    if (const auto* e = std::get_if<OdometryEvent>(&event.body)) text += "O:" + e->robot + seconds(e->utime);
    if (const auto* e = std::get_if<ScanEvent>(&event.body)) text += "S:" + e->robot + seconds(e->scan.utime);
    if (const auto* e = std::get_if<SightingEvent>(&event.body)) text += "B:" + e->robot + seconds(e->utime);
    text += "@" + seconds(event.receive_utime);
  }
  return text;
}

TEST(Import, TheOdometryOfALaserLineComesJustBeforeItsScan) {
  const TemporaryDirectory directory;
  CarmenImport what;
  what.logs = {{"r", directory.write("r.clf", odometry("1.0") + laser("1.1"))}};
  const auto events = import_carmen(what);
  EXPECT_EQ(shape(events), "R:R10@10 O:R10@10 O:R11@11 S:R11@11");
  EXPECT_EQ(std::get<OdometryEvent>(events[2].body).odom_from_robot, (Pose{3, 4, 0.5}));
}

TEST(Import, StampsThatRunBackKeepFileOrderAndTheReceiveTimeStays) {
  const TemporaryDirectory directory;
  CarmenImport what;
  what.logs = {{"r", directory.write("r.clf", odometry("2.0") + laser("1.5") + odometry("2.1"))}};
  EXPECT_EQ(shape(import_carmen(what)), "R:R20@20 O:R20@20 O:R15@20 S:R15@20 O:R21@21");
}

TEST(Import, RobotsAreMergedByEachOnesRunningMaximum) {
  const TemporaryDirectory directory;
  CarmenImport what;
  what.logs = {{"a", directory.write("a.clf", odometry("1.0") + odometry("3.0") + odometry("2.0"))},
               {"b", directory.write("b.clf", odometry("2.5") + odometry("3.0"))}};
  EXPECT_EQ(shape(import_carmen(what)), "R:A10@10 R:B10@10 O:A10@10 O:B25@25 O:A30@30 O:A20@30 O:B30@30");
}

TEST(Import, SightingsAreMergedByObserver) {
  const TemporaryDirectory directory;
  CarmenImport what;
  what.logs = {{"a", directory.write("a.clf", odometry("1.0") + odometry("3.0"))},
               {"b", directory.write("b.clf", odometry("2.0"))}};
  what.sightings_csv =
      directory.write("s.csv",
                      "utime_us,observer,barcode,range_m,bearing_rad,range_std_m,bearing_std_rad\n"
                      "2500000,b,7,1.5,-0.25,0.05,inf\n1500000,a,8,2,0.5,0.05,0.02\n");
  const auto events = import_carmen(what);
  EXPECT_EQ(shape(events), "R:A10@10 R:B10@10 O:A10@10 B:A15@15 O:B20@20 B:B25@25 O:A30@30");
  const auto sighting = std::get<SightingEvent>(events[5].body);
  EXPECT_EQ(sighting.barcode, 7);
  EXPECT_EQ(sighting.range_m, 1.5);
  EXPECT_EQ(sighting.range_sigma_m, 0.05);
  EXPECT_TRUE(std::isinf(sighting.bearing_sigma_rad));
}

TEST(Import, OptionsGoBeforeTheRobotTableAndThatBeforeTheLog) {
  const TemporaryDirectory directory;
  CarmenImport what;
  what.logs = {
      {"r",
       directory.write("r.clf",
                       "ROBOTLASER1 0 -1.5 3 0.01 30 0.01 0 1 2 0 0.1 0.2 0.3 0 0 0 0 0 0 0 0 5 host 5\n")}};
  const auto mount = [&] { return std::get<RobotEvent>(import_carmen(what)[0].body).laser.robot_from_laser; };
  EXPECT_EQ(mount(), (Pose{0.1, 0.2, 0.3}));
  what.robots_csv = directory.write("robots.csv", "robot,barcode,laser_x_m,laser_y_m\nR,101,-0.5,0.25\n");
  EXPECT_EQ(mount(), (Pose{-0.5, 0.25, 0.3}));
  EXPECT_EQ(std::get<RobotEvent>(import_carmen(what)[0].body).barcode, 101);
  what.laser_x_m = 1;
  EXPECT_EQ(mount(), (Pose{1, 0.25, 0.3}));
}

TEST(Import, TheNoReturnValueIsTheLargestWhereEnoughBeamsHaveIt) {
  const TemporaryDirectory directory;
  std::string many;
  for (int i = 0; i < 999; ++i) many += i % 2 == 0 ? "1 " : "2.5 ";
  const auto range_max_m = [&](const std::string& text) {
    return survey_carmen_log(directory.write("r.clf", text), false).range_max_m;
  };
  EXPECT_EQ(range_max_m(laser("1", many + "81.91", 1000)), static_cast<double>(81.91F));
  EXPECT_EQ(range_max_m(laser("1", many + "81.91", 1000) + laser("2", many + "1", 1000)), std::nullopt);
  EXPECT_EQ(range_max_m(laser("1", many + "inf", 1000)), 2.5);
  EXPECT_EQ(range_max_m(odometry("1")), std::nullopt);
}

TEST(Import, ARobotLasersMaximumRangeIsNoReturn) {
  const TemporaryDirectory directory;
  const std::string line = "ROBOTLASER1 0 -1.5 3 0.01 30 0.01 0 2 1 81.83 0 0 0 0 0 0 0 0 0 0 0 0 5 host 5\n";
  EXPECT_EQ(survey_carmen_log(directory.write("r.clf", line), false).range_max_m, 30);
}

TEST(Import, BadLinesAreErrorsThatNameFileLineAndReason) {
  const TemporaryDirectory directory;
  CarmenImport what;
  const std::string file = directory.write("r.clf", odometry("1.0") + "ODOM 1 2\n" + odometry("2.0"));
  what.logs = {{"r", file}};
  EXPECT_EQ(error_of([&] { import_carmen(what); }),
            file + ":2: wrong count of fields in ODOM: 3 instead of 10");
}

TEST(Import, NoEventIsGivenBeforeAllFilesAreChecked) {
  const TemporaryDirectory directory;
  CarmenImport what;
  what.logs = {{"a", directory.write("a.clf", odometry("1.0"))},
               {"b", directory.write("b.clf", "nonsense\n")}};
  int events = 0;
  EXPECT_NE(error_of([&] { import_carmen(what, [&](const Event&) { ++events; }); }), "");
  EXPECT_EQ(events, 0);
}

TEST(Import, BadLinesAreSkippedAndCountedOnRequest) {
  const TemporaryDirectory directory;
  CarmenImport what;
  what.skip_bad_lines = true;
  what.logs = {{"r", directory.write("r.clf", odometry("1.0") + "ODOM 1 2\n?\n" + odometry("2.0"))}};
  what.sightings_csv = directory.write(
      "s.csv",
      "utime_us,observer,barcode,range_m,bearing_rad,range_std_m,bearing_std_rad\nsoon,r,1,1,1,1,1\n"
      "1500000,r,8,2,0.5,0.05,-1\n1500000,r,8,2,0.5,0.05,0.02\n");
  std::vector<Event> events;
  const auto report = import_carmen(what, [&](const Event& event) { events.push_back(event); });
  EXPECT_EQ(report.bad_lines, 4);
  EXPECT_EQ(shape(events), "R:R10@10 O:R10@10 B:R15@15 O:R20@20");
}

TEST(Import, AFileThatIsNoLogIsSaidToBeNone) {
  const TemporaryDirectory directory;
  CarmenImport what;
  what.skip_bad_lines = true;
  const std::string file = directory.write("r.clf", std::string("\x7f"
                                                                "ELF\0\n\x01\x02",
                                                                8));
  what.logs = {{"r", file}};
  EXPECT_EQ(error_of([&] { import_carmen(what); }),
            file + ": no odometry and no laser line: not a CARMEN log");
}

TEST(Import, RobotsMustBeNamedProperlyAndOnce) {
  const TemporaryDirectory directory;
  const std::string file = directory.write("r.clf", odometry("1.0"));
  CarmenImport what;
  EXPECT_EQ(error_of([&] { import_carmen(what); }), "no log is given");
  what.logs = {{"r1", file}, {"R1", file}};
  EXPECT_EQ(error_of([&] { import_carmen(what); }), "robot R1 is given twice");
  what.logs = {{"../r", file}};
  EXPECT_EQ(error_of([&] { import_carmen(what); }), "not a robot's name: '../r'");
}

TEST(Import, TablesThatDoNotFitAreErrors) {
  const TemporaryDirectory directory;
  CarmenImport what;
  what.logs = {{"r", directory.write("r.clf", odometry("1.0"))}};
  what.robots_csv = directory / "robots.csv";
  const auto with_robots = [&](const std::string& text) {
    directory.write("robots.csv", text);
    return error_of([&] { import_carmen(what); });
  };
  EXPECT_EQ(with_robots("robot,barcode\nq,1\n"), what.robots_csv + ": no row for robot R");
  EXPECT_EQ(with_robots("robot,barcode\nr,1\nq,1\n"), what.robots_csv + ":3: barcode 1 is another robot's");
  EXPECT_EQ(with_robots("robot,barcode\nr,1\nR,2\n"), what.robots_csv + ":3: robot R twice");
  what.robots_csv.clear();
  what.sightings_csv = directory.write("s.csv", "utime_us,observer,barcode\n");
  EXPECT_EQ(error_of([&] { import_carmen(what); }),
            what.sightings_csv + ":1: no column 'range_m' in the header");
  what.sightings_csv = directory.write(
      "s.csv", "utime_us,observer,barcode,range_m,bearing_rad,range_std_m,bearing_std_rad\n1,x,1,1,1,1,1\n");
  EXPECT_EQ(error_of([&] { import_carmen(what); }),
            what.sightings_csv + ": observer X has no log: give --robot for it");
}

}  // namespace
}  // namespace isthmus
