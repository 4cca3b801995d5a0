#pragma once

#include <string>
#include <vector>

#include "server/engine/record/map_copy.hpp"
#include "tests/support/ways.hpp"

namespace isthmus::testing {

/// A robot drives through a hall of niches, and once more, where the map has it moved by so much.
///
///     0 --> 1 --> ... 11
///    12 --> ...       23       0.3 m beside it
inline Map map_of_hall_driven_twice(const Pose& off, const std::string& second_robot = "R1") {
  Map map;
  std::vector<Pose> there;
  std::vector<Pose> back;
  for (int i = 0; i < 12; ++i) {
    there.push_back({0.0 + 1.5 * i, 0, 0});
    back.push_back({0.7 + 1.5 * i, 0.3, 0});
  }
  const std::vector<PatchId> first = add_way(map, niched_hall(), there);
  const std::vector<PatchId> second = add_way(map, niched_hall(), back, off, second_robot);
  map.relate(odometry_relation(first.back(), second.back(), map.relative_pose(first.back(), second.back())));
  return map;
}

inline MapCopy hall_driven_twice(const Pose& off, const std::string& second_robot = "R1") {
  const Map map = map_of_hall_driven_twice(off, second_robot);
  MapCopy copy;
  copy.patches.assign(map.manifold().patches().begin(), map.manifold().patches().end());
  copy.poses.assign(map.manifold().poses().begin(), map.manifold().poses().end());
  copy.graph = map.graph();
  return copy;
}

}  // namespace isthmus::testing
