#include "tools/import/mrclam.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/import/event_source.hpp"
#include "tools/text/lines.hpp"

namespace isthmus {
namespace {

constexpr double footprint_radius_m = 0.17;  // an iRobot Create

/// One robot's files, its stamps moved to when things happened.
struct RobotFiles {
  std::string robot;
  std::int32_t barcode = -1;
  std::vector<VelocityLine> velocities;
  std::vector<MeasurementLine> measurements;
};

std::int64_t microseconds(double seconds) { return std::llround(1e6 * seconds); }

std::int32_t barcode_of(const std::map<int, std::int32_t>& barcodes, int subject, const std::string& file) {
  const auto found = barcodes.find(subject);
  if (found == barcodes.end()) throw FileError(file, 0, "no barcode of subject " + std::to_string(subject));
  return found->second;
}

RobotFiles read_robot(const MrclamImport& what, int subject, std::int32_t barcode) {
  const std::string prefix = "Robot" + std::to_string(subject);
  RobotFiles files;
  files.robot = "R" + std::to_string(subject);
  files.barcode = barcode;
  files.velocities = read_velocities(mrclam_file(what.directory, prefix + "_Odometry"));
  files.measurements = read_measurements(mrclam_file(what.directory, prefix + "_Measurement"));
  for (VelocityLine& line : files.velocities) line.utime += microseconds(what.odometry_lag_s);
  for (MeasurementLine& line : files.measurements) line.utime -= microseconds(what.sighting_lag_s);
  return files;
}

std::int64_t first_utime(const std::vector<RobotFiles>& robots) {
  std::int64_t first = std::numeric_limits<std::int64_t>::max();
  for (const RobotFiles& files : robots) {
    first = std::min(first, files.velocities.front().utime);
    if (!files.measurements.empty()) first = std::min(first, files.measurements.front().utime);
  }
  return first;
}

RobotEvent describe(const RobotFiles& files, std::int64_t utime) {
  RobotEvent event;
  event.robot = files.robot;
  event.utime = utime;
  event.barcode = files.barcode;
  event.laser = {{}, 0, 0};
  event.footprint_radius_m = footprint_radius_m;
  return event;
}

void leave_out_robots(const std::map<int, std::int32_t>& barcodes, std::vector<MeasurementLine>& lines) {
  for (const auto& [subject, barcode] : barcodes) {
    if (subject > last_mrclam_robot) continue;
    std::erase_if(lines, [worn = barcode](const MeasurementLine& line) { return line.barcode == worn; });
  }
}

ListSource odometry_source(const RobotFiles& files, double longest_hold_s) {
  const std::vector<Pose> poses = integrate_velocities(files.velocities, longest_hold_s);
  ListSource source;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const std::int64_t utime = files.velocities[i].utime;
    source.add(utime, OdometryEvent{files.robot, utime, poses[i]});
  }
  return source;
}

ListSource sighting_source(const RobotFiles& files, const MrclamImport& what) {
  ListSource source;
  for (const MeasurementLine& line : files.measurements) {
    const double range_sigma_m = std::hypot(what.range_std_m, what.range_std_share * line.range_m);
    source.add(line.utime, SightingEvent{files.robot, line.utime, line.barcode, line.range_m, range_sigma_m,
                                         line.bearing_rad, what.bearing_std_rad});
  }
  return source;
}

}  // namespace

std::vector<Pose> integrate_velocities(std::span<const VelocityLine> lines, double longest_hold_s) {
  std::vector<Pose> poses;
  Pose pose;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (i > 0) {
      const VelocityLine& held = lines[i - 1];
      const double elapsed_s = 1e-6 * static_cast<double>(lines[i].utime - held.utime);
      const double held_s = std::clamp(elapsed_s, 0.0, longest_hold_s);
      // The chord of an arc that turns by 2h points along h and is sin(h)/h times as long as the arc.
      const double h = 0.5 * held.turn_rad_s * held_s;
      const double shortening = std::abs(h) < 1e-4 ? 1 - h * h / 6 : std::sin(h) / h;
      const double chord_m = held.forward_m_s * held_s * shortening;
      pose = pose * Pose{chord_m * std::cos(h), chord_m * std::sin(h), wrap_angle(2 * h)};
    }
    poses.push_back(pose);
  }
  return poses;
}

ImportReport import_mrclam(const MrclamImport& what, const std::function<void(const Event&)>& sink,
                           const std::function<void(double)>& progress) {
  const std::string barcode_file = mrclam_file(what.directory, "Barcodes");
  const std::map<int, std::int32_t> barcodes = read_barcodes(barcode_file);
  std::vector<RobotFiles> robots;
  for (const int subject : mrclam_robots(what.directory)) {
    robots.push_back(read_robot(what, subject, barcode_of(barcodes, subject, barcode_file)));
  }
  const std::int64_t start = first_utime(robots);
  if (!what.robot_sightings) {
    for (RobotFiles& files : robots) leave_out_robots(barcodes, files.measurements);
  }

  ImportReport report;
  std::vector<ListSource> sources;
  for (const RobotFiles& files : robots) {
    report.robots.push_back(describe(files, start));
    report.odometry += static_cast<long>(files.velocities.size());
    report.sightings += static_cast<long>(files.measurements.size());
    sources.push_back(odometry_source(files, what.longest_hold_s));
  }
  for (const RobotFiles& files : robots) sources.push_back(sighting_source(files, what));

  for (const RobotEvent& robot : report.robots) sink({start, robot});
  for (const auto& [subject, barcode] : barcodes) {
    if (subject <= last_mrclam_robot) continue;
    sink({start, TagEvent{start, barcode}});
    ++report.tags;
  }
  std::vector<EventSource*> all;
  for (ListSource& source : sources) all.push_back(&source);
  merge_sources(all, sink, progress);
  return report;
}

std::vector<Event> import_mrclam(const MrclamImport& what) {
  std::vector<Event> events;
  import_mrclam(what, [&](const Event& event) { events.push_back(event); });
  return events;
}

}  // namespace isthmus
