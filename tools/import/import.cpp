#include "tools/import/import.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>

#include "tools/import/carmen_log.hpp"
#include "tools/import/event_source.hpp"
#include "tools/import/robot_table.hpp"
#include "tools/import/sighting_table.hpp"

namespace isthmus {
namespace {

class LogSource final : public EventSource {
 public:
  LogSource(std::string robot, const std::string& file, bool skip_bad_lines)
      : robot_(std::move(robot)), reader_(file, skip_bad_lines) {}
  double progress() const override { return reader_.progress(); }

 private:
  bool read(std::vector<Event>& events) override {
    auto line = reader_.next();
    if (!line) return false;
    note(line->utime);
    events.push_back({0, OdometryEvent{robot_, line->utime, line->odom_from_robot}});
    if (line->laser) events.push_back({0, ScanEvent{robot_, std::move(line->laser->scan)}});
    return true;
  }

  std::string robot_;
  CarmenReader reader_;
};

std::vector<RobotLog> checked_logs(const CarmenImport& what) {
  std::vector<RobotLog> logs = what.logs;
  for (RobotLog& log : logs) {
    const auto name = robot_name(log.robot);
    if (!name) throw std::runtime_error("not a robot's name: '" + log.robot + "'");
    log.robot = *name;
  }
  for (std::size_t i = 0; i < logs.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (logs[i].robot == logs[j].robot)
        throw std::runtime_error("robot " + logs[i].robot + " is given twice");
    }
  }
  if (logs.empty()) throw std::runtime_error("no log is given");
  return logs;
}

/// What a robot says of itself: the options go before robots.csv, that before the log.
RobotEvent describe(const std::string& robot, const CarmenImport& what, const RobotRow& row,
                    const CarmenFacts& facts) {
  RobotEvent event;
  event.robot = robot;
  event.barcode = row.barcode;
  Laser& laser = event.laser;
  laser.robot_from_laser = facts.robot_from_laser.value_or(Pose{});
  Pose& mount = laser.robot_from_laser;
  mount.x = what.laser_x_m.value_or(row.laser_x_m.value_or(mount.x));
  mount.y = what.laser_y_m.value_or(row.laser_y_m.value_or(mount.y));
  mount.yaw = wrap_angle(what.laser_yaw_rad.value_or(row.laser_yaw_rad.value_or(mount.yaw)));
  laser.range_min_m = row.range_min_m.value_or(laser.range_min_m);
  laser.range_max_m =
      what.range_max_m.value_or(row.range_max_m.value_or(facts.range_max_m.value_or(laser.range_max_m)));
  event.footprint_radius_m = row.footprint_radius_m.value_or(event.footprint_radius_m);
  return event;
}

/// Sightings by observer, each a source of its own; an observer without a log is an error, since nothing
/// would ever tell where it was.
std::map<std::string, ListSource> sighting_sources(const std::vector<SightingEvent>& sightings,
                                                   const std::vector<RobotLog>& logs,
                                                   const std::string& file) {
  std::map<std::string, ListSource> sources;
  for (const SightingEvent& sighting : sightings) {
    const bool known = std::any_of(logs.begin(), logs.end(),
                                   [&](const RobotLog& log) { return log.robot == sighting.robot; });
    if (!known) throw FileError(file, 0, "observer " + sighting.robot + " has no log: give --robot for it");
    sources[sighting.robot].add(sighting.utime, sighting);
  }
  return sources;
}

/// Reads all logs once for what they tell of robots. Returns the earliest stamp.
std::int64_t survey_logs(const CarmenImport& what, const std::vector<RobotLog>& logs, ImportReport& report) {
  std::map<std::string, RobotRow> table;
  if (!what.robots_csv.empty()) table = read_robot_table(what.robots_csv);
  std::int64_t start = std::numeric_limits<std::int64_t>::max();
  for (const RobotLog& log : logs) {
    if (!what.robots_csv.empty() && !table.contains(log.robot)) {
      throw FileError(what.robots_csv, 0, "no row for robot " + log.robot);
    }
    const CarmenFacts facts = survey_carmen_log(log.file, what.skip_bad_lines);
    report.odometry += facts.odometry_lines + facts.scans;
    report.scans += facts.scans;
    report.bad_lines += facts.bad_lines;
    report.robots.push_back(describe(log.robot, what, table[log.robot], facts));
    start = std::min(start, facts.first_utime);
  }
  return start;
}

}  // namespace

ImportReport import_carmen(const CarmenImport& what, const std::function<void(const Event&)>& sink,
                           const std::function<void(double)>& progress) {
  const std::vector<RobotLog> logs = checked_logs(what);
  ImportReport report;
  std::vector<SightingEvent> sightings;
  if (!what.sightings_csv.empty()) {
    sightings = read_sighting_table(what.sightings_csv, what.skip_bad_lines, report.bad_lines);
  }
  auto observers = sighting_sources(sightings, logs, what.sightings_csv);

  std::int64_t start = survey_logs(what, logs, report);
  report.sightings = static_cast<long>(sightings.size());
  for (const SightingEvent& sighting : sightings) start = std::min(start, sighting.utime);

  for (RobotEvent& robot : report.robots) {
    robot.utime = start;
    sink({start, robot});
  }
  std::vector<std::unique_ptr<LogSource>> log_sources;
  std::vector<EventSource*> sources;
  for (const RobotLog& log : logs) {
    log_sources.push_back(std::make_unique<LogSource>(log.robot, log.file, what.skip_bad_lines));
    sources.push_back(log_sources.back().get());
  }
  for (auto& [robot, source] : observers) sources.push_back(&source);
  merge_sources(sources, sink, progress);
  return report;
}

std::vector<Event> import_carmen(const CarmenImport& what) {
  std::vector<Event> events;
  import_carmen(what, [&](const Event& event) { events.push_back(event); });
  return events;
}

}  // namespace isthmus
