#pragma once

#include <string>
#include <vector>

#include "server/engine/input/event.hpp"
#include "tests/support/walls.hpp"

namespace isthmus::testing {

/// Events of robots whose odometry and sightings are exact; a second of the run is 1,000,000 µs.
class FeatureEvents {
 public:
  void declare(const std::string& robot, std::int32_t barcode, double range_max_m) {
    RobotEvent event;
    event.robot = robot;
    event.utime = now_;
    event.barcode = barcode;
    event.laser = laser_of();
    event.laser.range_max_m = range_max_m;
    add(event);
  }
  void tag(std::int32_t barcode) { add(TagEvent{now_, barcode}); }
  void odometry(const std::string& robot, const Pose& odom_from_robot) {
    add(OdometryEvent{robot, now_, odom_from_robot});
  }
  void scan(const std::string& robot, const Walls& walls, const Pose& world_from_robot) {
    add(ScanEvent{robot, scan_from(walls, world_from_robot, now_)});
  }
  void sighting(const std::string& observer, std::int32_t barcode, const Eigen::Vector2d& in_robot) {
    add(SightingEvent{observer, now_, barcode, in_robot.norm(), 0.02, std::atan2(in_robot.y(), in_robot.x()),
                      0.01});
  }
  void wait(double seconds) { now_ += static_cast<std::int64_t>(1e6 * seconds); }
  void add(const decltype(Event::body)& body) { events.push_back({now_, body}); }

  std::vector<Event> events;

 private:
  std::int64_t now_ = 1'000'000;
};

}  // namespace isthmus::testing
