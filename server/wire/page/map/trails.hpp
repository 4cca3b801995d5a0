#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "server/engine/robot/robot_pose.hpp"
#include "server/wire/page/map/shown_map.hpp"

namespace isthmus {

/// Where robots were lately, on the manifold: a fit of the map moves their trails along.
class Trails {
 public:
  struct Robot {
    RobotPose newest;
    RobotPose at_step;               ///< the newest when the trail's last step was made
    std::deque<ManifoldPose> trail;  ///< half a metre apart, the last 100 m
    std::deque<RobotPose> lately;    ///< a tenth of a second apart, 400 at most
    bool heard = true;  ///< false: all this is from the map, and the robot may be elsewhere by now
  };

  void add(const RobotPose& pose);
  /// Of robots that have no trail yet, those that are told by the map.
  void add_from_map(Trails of_map);
  /// As if the robot had never been heard.
  void forget(const std::string& robot) { robots_.erase(robot); }
  const std::map<std::string, Robot>& robots() const { return robots_; }

  /// Where a robot was, as of its pose nearest in time; nothing where that is more than half a second away.
  std::optional<ManifoldPose> at(const std::string& robot, std::int64_t utime) const;

 private:
  std::map<std::string, Robot> robots_;
};

/// Robots whose data operators have dropped.
std::set<std::string> left_out_robots(const MapCopy& map);

/// Where robots were last, and the ways that they came there, as the map's trajectory tells; of none that was
/// dropped.
Trails trails_of(const ShownMap& shown);

}  // namespace isthmus
