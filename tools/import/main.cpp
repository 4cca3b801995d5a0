#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>

#include "server/wire/event_log.hpp"
#include "tools/import/import.hpp"
#include "tools/text/progress.hpp"

namespace {

using namespace isthmus;

/// "R1=r1.clf.gz"
RobotLog parse_robot(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == 0 || equals == text.npos || equals + 1 == text.size()) {
    throw CLI::ValidationError("--robot", "expected NAME=FILE instead of '" + text + "'");
  }
  return {text.substr(0, equals), text.substr(equals + 1)};
}

void print(const ImportReport& report, const std::string& output) {
  for (const RobotEvent& robot : report.robots) {
    const Pose& mount = robot.laser.robot_from_laser;
    std::printf("%s: barcode %d, laser at (%g, %g) m, %g rad, no return from %g m\n", robot.robot.c_str(),
                robot.barcode, mount.x, mount.y, mount.yaw, robot.laser.range_max_m);
  }
  if (report.bad_lines > 0) std::printf("%ld bad lines skipped\n", report.bad_lines);
  std::printf("%ld scans, %ld odometry, %ld sightings -> %s\n", report.scans, report.odometry,
              report.sightings, output.c_str());
}

void run_carmen(const CarmenImport& what, const std::string& output) {
  EventLogWriter writer(output);
  ImportReport report;
  {
    Progress progress("import");
    report = import_carmen(
        what, [&](const Event& event) { writer.write(encode(event)); },
        [&](double share) { progress.update(share); });
  }
  writer.finish();
  print(report, output);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Turns recorded robot logs into an LCM event log.", "isthmus-import");
  app.require_subcommand(1);
  CLI::App* carmen = app.add_subcommand("carmen", "CARMEN logs (ODOM, FLASER, ROBOTLASER1), plain or gz");
  CarmenImport what;
  std::vector<std::string> robots;
  std::string output;
  carmen->add_option("--robot", robots, "a robot and its log, NAME=FILE; repeat for a team")->required();
  carmen->add_option("--robots", what.robots_csv, "robots.csv: barcodes and laser mounts");
  carmen->add_option("--sightings", what.sightings_csv, "sightings.csv: who saw which barcode");
  carmen->add_option("--laser-x", what.laser_x_m, "laser position on the robot, m, forward");
  carmen->add_option("--laser-y", what.laser_y_m, "laser position on the robot, m, left");
  carmen->add_option("--laser-yaw", what.laser_yaw_rad, "laser direction on the robot, rad");
  carmen->add_option("--range-max", what.range_max_m, "ranges from here on are no return, m");
  carmen->add_flag("--skip-bad-lines", what.skip_bad_lines,
                   "pass over lines that cannot be read, and count them");
  carmen->add_option("-o,--output", output, "the LCM event log to write")->required();
  try {
    app.parse(argc, argv);
    for (const std::string& robot : robots) what.logs.push_back(parse_robot(robot));
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    run_carmen(what, output);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "isthmus-import: %s\n", error.what());
    return 1;
  }
  return 0;
}
