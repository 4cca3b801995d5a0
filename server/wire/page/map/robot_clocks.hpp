#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "server/engine/record/map_copy.hpp"

namespace isthmus {

/// What robots' stamps are by the server's clock, so that what came together is shown together, whatever
/// their own clocks say. A clock is ahead by what the stamp of the robot's fastest message was
/// (HealthFigures::clock_ahead_s).
class RobotClocks {
 public:
  RobotClocks() = default;
  explicit RobotClocks(const MapCopy& map);

  /// Microseconds, within some 127,000 years of 1970; the stamp where nothing is known of the robot's clock.
  std::int64_t server_utime(const std::string& robot, std::int64_t utime) const;

 private:
  std::map<std::string, double> ahead_us_;
};

}  // namespace isthmus
