#include <CLI/CLI.hpp>
#include <cstdio>
#include <functional>
#include <memory>

#include "server/program/command_line.hpp"
#include "server/program/new_output.hpp"
#include "server/program/values.hpp"
#include "server/wire/journal/event_log.hpp"
#include "tools/import/import.hpp"
#include "tools/import/mrclam.hpp"
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
  for (const auto& [robot, utime, barcode, laser, footprint_radius_m, restarted] : report.robots) {
    const Pose& mount = laser.robot_from_laser;
    if (laser.range_max_m == 0) {
      std::printf("%s: barcode %d, no laser\n", robot.c_str(), barcode);
    } else {
      std::printf("%s: barcode %d, laser at (%g, %g) m, %g rad, no return from %g m\n", robot.c_str(),
                  barcode, mount.x, mount.y, mount.yaw, laser.range_max_m);
    }
  }
  if (report.bad_lines > 0) std::printf("%ld bad lines skipped\n", report.bad_lines);
  if (report.tags > 0) std::printf("%ld fixed tags\n", report.tags);
  std::printf("%ld scans, %ld odometry, %ld sightings -> %s\n", report.scans, report.odometry,
              report.sightings, output.c_str());
}

template <class Import>
void import_into(const std::string& output, const Import& what,
                 ImportReport (*import)(const Import&, const std::function<void(const Event&)>&,
                                        const std::function<void(double)>&)) {
  EventLogWriter writer(output);
  ImportReport report;
  {
    Progress progress("import");
    report = import(
        what, [&](const Event& event) { writer.write(encode(event)); },
        [&](double share) { progress.update(share); });
  }
  writer.finish();
  print(report, output);
  if (report.scans + report.odometry + report.sightings == 0)
    throw std::runtime_error(output + ": nothing was imported");
}

/// What one way of importing needs: its options, and what it does once they are read.
struct Command {
  CLI::App* app = nullptr;
  std::function<void()> run;
};

Command carmen_command(CLI::App& app, CarmenImport& what, std::string& output, bool& force) {
  CLI::App* carmen = app.add_subcommand("carmen", "CARMEN logs (ODOM, FLASER, ROBOTLASER1), plain or gz");
  auto robots = std::make_shared<std::vector<std::string>>();
  carmen->add_option("--robot", *robots, "a robot and its log, NAME=FILE; repeat for a team")->required();
  carmen->add_option("--robots", what.robots_csv, "robots.csv: barcodes and laser mounts");
  carmen->add_option("--sightings", what.sightings_csv, "sightings.csv: who saw which barcode");
  carmen->add_option("--laser-x", what.laser_x_m, "laser position on the robot, metres forward");
  carmen->add_option("--laser-y", what.laser_y_m, "laser position on the robot, metres left");
  carmen->add_option("--laser-yaw", what.laser_yaw_rad, "laser direction on the robot, rad");
  carmen->add_option("--range-max", what.range_max_m, "ranges of this and more are no return, metres");
  carmen->add_flag("--skip-bad-lines", what.skip_bad_lines, "skip and count lines that cannot be read");
  carmen->add_option("-o,--output", output, "the LCM event log to write")->required();
  add_force(*carmen, force);
  carmen->parse_complete_callback([robots, &what] {
    for (const std::string& robot : *robots) what.logs.push_back(parse_robot(robot));
  });
  return {carmen, [&] { import_into(output, what, &import_carmen); }};
}

Command mrclam_command(CLI::App& app, MrclamImport& what, std::string& output, std::string& truth,
                       bool& force) {
  CLI::App* mrclam = app.add_subcommand("mrclam", "a UTIAS MRCLAM set: robots and landmarks with barcodes");
  const auto number = [&](const char* name, double& value, const char* help, const CLI::Validator& check) {
    mrclam->add_option(name, value, help)->check(check)->capture_default_str();
  };
  const CLI::Validator sigma = number_in(1e-6, 1e3);
  const CLI::Validator seconds = number_in(0.0, 60.0);
  mrclam->add_option("directory", what.directory, "the set's files, plain or gz")->required();
  mrclam->add_option("-o,--output", output, "the LCM event log to write")->required();
  add_force(*mrclam, force);
  mrclam->add_option("--truth", truth, "write the true ROBOT.tum and tags.csv into this directory");
  number("--range-std", what.range_std_m, "standard deviation of a range of 0 m, metres", sigma);
  number("--range-std-share", what.range_std_share, "standard deviation added per metre of range",
         number_in(0.0, 1.0));
  number("--bearing-std", what.bearing_std_rad, "sigma of a bearing, rad", sigma);
  number("--odometry-lag", what.odometry_lag_s, "a robot moves so much after its odometry's stamp, s",
         seconds);
  number("--sighting-lag", what.sighting_lag_s, "a sighting is so much older than its stamp, s", seconds);
  number("--longest-hold", what.longest_hold_s, "a velocity holds no longer than this, s", seconds);
  auto without_robots = std::make_shared<bool>(false);
  mrclam->add_flag("--without-robot-sightings", *without_robots, "leave out what robots saw of one another");
  return {mrclam, [&, without_robots] {
            what.robot_sightings = !*without_robots;
            import_into(output, what, &import_mrclam);
            if (!truth.empty()) write_mrclam_truth(what.directory, truth);
          }};
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Turns recorded robot logs into an LCM event log.", "isthmus-import");
  app.require_subcommand(1);
  CarmenImport carmen;
  MrclamImport mrclam;
  std::string output;
  std::string truth;
  bool force = false;
  const Command commands[] = {carmen_command(app, carmen, output, force),
                              mrclam_command(app, mrclam, output, truth, force)};
  return run_program(app, argc, argv, [&] {
    check_new_file(output, force);
    check_new_files_in(truth, {".tum", ".csv"}, force);
    for (const Command& command : commands) {
      if (command.app->parsed()) command.run();
    }
  });
}
