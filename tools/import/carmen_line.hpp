#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "patches/scan.hpp"

namespace isthmus {

/// The laser part of a CARMEN line. ROBOTLASER1 tells its mount and its maximum range, FLASER neither.
struct CarmenScan {
  Scan scan;
  std::optional<Pose> robot_from_laser;
  std::optional<double> range_max_m;
};

/// One ODOM, FLASER or ROBOTLASER1 line (tools/README.md): a stamp, the odometry, and a scan where
/// the line has one. The stamp is the first of the two on the line, that of the message (`ipc_timestamp`):
/// the one which the ground truth of the SLAM benchmark refers to.
struct CarmenLine {
  std::int64_t utime = 0;
  Pose odom_from_robot;
  std::optional<CarmenScan> laser;
};

/// A line that says nothing about odometry or laser: empty, a comment, a parameter, another sensor.
struct CarmenOther {};

/// A line, or the reason why it cannot be read.
using ParsedCarmenLine = std::variant<CarmenLine, CarmenOther, std::string>;

ParsedCarmenLine parse_carmen_line(std::string_view line);

}  // namespace isthmus
