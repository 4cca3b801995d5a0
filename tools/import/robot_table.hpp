#pragma once

#include <map>
#include <optional>
#include <string>

namespace isthmus {

/// A row of robots.csv: `robot,barcode,laser_x_m,laser_y_m,laser_yaw_rad,…`. All but the first two columns
/// may be missing; `range_min_m`, `range_max_m` and `footprint_radius_m` are known too, others are passed
/// over.
struct RobotRow {
  std::int32_t barcode = -1;
  std::optional<double> laser_x_m;
  std::optional<double> laser_y_m;
  std::optional<double> laser_yaw_rad;
  std::optional<double> range_min_m;
  std::optional<double> range_max_m;
  std::optional<double> footprint_radius_m;
};

/// By upper-case name. Throws FileError naming file, line and reason: a name twice, a barcode twice.
std::map<std::string, RobotRow> read_robot_table(const std::string& file);

/// The name in upper case; nothing where it cannot be a robot's (server/engine/input/robot_name.hpp).
std::optional<std::string> robot_name(const std::string& name);

}  // namespace isthmus
