#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "server/wire/message/message.hpp"

namespace isthmus {

/// A robot that drives to and fro in a box of 8 x 6 m and tells of it, without noise:
///
///      6 +----------------+
///        |                |
///      3 |  1 --> ... 7   |
///        |                |
///      0 +----------------+
///        0                8
///
/// Its messages come in rounds of odometry and scan, every 0.1 s.
class BoxRoomRobot {
 public:
  explicit BoxRoomRobot(std::string name, std::int32_t barcode = -1)
      : name_(std::move(name)), barcode_(barcode) {}

  Message introduction() const {
    RobotEvent robot;
    robot.robot = name_;
    robot.utime = start_utime;
    robot.barcode = barcode_;
    robot.laser.range_max_m = 30;
    return encode({start_utime, robot});
  }

  std::vector<Message> round(int number) const {
    const std::int64_t utime = start_utime + 100'000 * number;
    const double way = std::fmod(0.05 * number, 12.0);
    const Pose pose{1 + std::min(way, 12 - way), 3 + 0.2 * std::sin(0.1 * number),
                    0.3 * std::sin(0.05 * number)};
    return {encode({utime, OdometryEvent{name_, utime, pose}}),
            encode({utime, ScanEvent{name_, scan(utime, pose)}})};
  }

 private:
  static constexpr std::int64_t start_utime = 1'000'000'000;

  static float range_m(const Pose& pose, double bearing_rad) {
    const double c = std::cos(pose.yaw + bearing_rad), s = std::sin(pose.yaw + bearing_rad);
    const double to_x = std::abs(c) < 1e-9 ? 1e9 : ((c > 0 ? 8 : 0) - pose.x) / c;
    const double to_y = std::abs(s) < 1e-9 ? 1e9 : ((s > 0 ? 6 : 0) - pose.y) / s;
    return static_cast<float>(std::min(to_x, to_y));
  }

  static Scan scan(std::int64_t utime, const Pose& pose) {
    Scan scan{utime, -1.5, 3.0 / 90, {}};
    for (int beam = 0; beam <= 90; ++beam) {
      scan.ranges_m.push_back(range_m(pose, scan.bearing0_rad + beam * scan.bearing_step_rad));
    }
    return scan;
  }

  std::string name_;
  std::int32_t barcode_;
};

}  // namespace isthmus
