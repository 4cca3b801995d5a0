#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "server/engine/input/drop_reason.hpp"
#include "server/engine/robot/robot_health.hpp"

namespace isthmus {

/// Something about a robot's data that looks wrong.
struct HealthWarning {
  std::string key;   ///< lower_case, the same in every release
  std::string text;  ///< a sentence for people, with the robot's name
};

/// A robot's own data, and what looks wrong with it.
struct HealthRecord {
  std::string robot;
  HealthFigures figures;
  std::vector<HealthWarning> warnings;
  double scan_delay_s = 0;  ///< by which scans are taken to be stamped later than odometry (ScanDelay)
};

/// What looks wrong with a robot's data; nothing while too little is known. Of warnings with the same cause,
/// the plainest. `dropped`: its messages.
std::vector<HealthWarning> health_warnings(const std::string& robot, const Laser& laser,
                                           const HealthFigures& figures,
                                           const std::map<DropReason, std::int64_t>& dropped,
                                           const HealthWarningOptions& options);

}  // namespace isthmus
