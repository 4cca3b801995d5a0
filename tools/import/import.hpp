#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/engine/input/event.hpp"

namespace isthmus {

struct RobotLog {
  std::string robot;
  std::string file;  ///< a CARMEN log, plain or gz
};

struct CarmenImport {
  std::vector<RobotLog> logs;
  std::string robots_csv;     ///< empty: none
  std::string sightings_csv;  ///< empty: none
  bool skip_bad_lines = false;
  /// Where given, these hold for every robot, before robots.csv and the log itself.
  std::optional<double> laser_x_m;
  std::optional<double> laser_y_m;
  std::optional<double> laser_yaw_rad;
  std::optional<double> range_max_m;
};

struct ImportReport {
  long odometry = 0;  ///< ODOM lines and the odometry of laser lines
  long scans = 0;
  long sightings = 0;
  long tags = 0;
  long bad_lines = 0;
  std::vector<RobotEvent> robots;
};

/// Turns CARMEN logs into events (lcmtypes/README.md): first what every robot says of itself, then
/// all robots merged by each one's running-maximum stamp, file order within a robot; that maximum is the
/// receive time. The odometry of a laser line comes as an odometry event just before its scan with the same
/// stamp. Throws FileError naming file, line and reason, or std::runtime_error; all files are checked before
/// the first event. `progress` gets the share of the work done.
ImportReport import_carmen(const CarmenImport& what, const std::function<void(const Event&)>& sink,
                           const std::function<void(double)>& progress = {});

std::vector<Event> import_carmen(const CarmenImport& what);

}  // namespace isthmus
