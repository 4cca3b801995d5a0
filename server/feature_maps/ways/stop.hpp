#pragma once

#include <cstdint>
#include <tuple>
#include <vector>

#include "patches/features/m_space.hpp"
#include "server/engine/robot/robot.hpp"
#include "server/features/state/measurement.hpp"

namespace isthmus {

/// A feature of the map as a robot saw it.
struct FeatureView {
  int id = 0;               ///< in the map that it is in by now
  bool line_alone = false;  ///< its ends tell nothing
  ObservedFeature seen;     ///< in the robot's frame

  bool is_sound() const { return isthmus::is_sound(seen); }
  auto members() { return std::tie(id, line_alone, seen); }
};

/// Another robot of the same map as it saw it.
struct RobotView {
  int way = 0;   ///< number of the other's journey,
  int stop = 0;  ///< and its stop then
  RelativeSighting seen;

  auto members() { return std::tie(way, stop, seen); }
};

/// A place on a robot's way from which it saw features of its map, and how it had come there.
struct Stop {
  std::int64_t utime = 0;
  Pose map_from_robot;     ///< as the filter had it then, in the map's frame
  OdometryPath from_last;  ///< from the stop before, or from where the way begins
  std::vector<FeatureView> views;
  std::vector<RobotView> robots;

  auto members() { return std::tie(utime, map_from_robot, from_last, views, robots); }
};

}  // namespace isthmus
