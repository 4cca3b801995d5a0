#include "server/wire/page/map/robot_clocks.hpp"

#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

/// Stamps are anything that a robot may send: the difference of two of these is still a number.
constexpr double largest_us = 4e18;

}  // namespace

RobotClocks::RobotClocks(const MapCopy& map) {
  for (const HealthRecord& record : map.health)
    if (record.figures.clock_ahead_s) ahead_us_[record.robot] = 1e6 * *record.figures.clock_ahead_s;
}

std::int64_t RobotClocks::server_utime(const std::string& robot, std::int64_t utime) const {
  const auto ahead = ahead_us_.find(robot);
  const double ahead_us = ahead == ahead_us_.end() ? 0 : ahead->second;
  return std::llround(std::clamp(static_cast<double>(utime) - ahead_us, -largest_us, largest_us));
}

}  // namespace isthmus
