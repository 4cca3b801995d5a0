#pragma once

#include <string>
#include <utility>
#include <vector>

#include "server/engine/annotations/annotations.hpp"
#include "tests/support/rectangle.hpp"
#include "tests/support/ways.hpp"

namespace isthmus::testing {

/// A way of patches a metre apart along x, from `from_x` on, on an island of its own.
inline std::vector<PatchId> add_line(Map& map, int patches, double from_x = 0,
                                     const std::string& robot = "R1") {
  std::vector<Pose> poses;
  for (int i = 0; i < patches; ++i) poses.push_back({from_x + i, 0, 0});
  Walls room;
  add_box(room, -5, -5, 60, 5);
  return add_way(map, room, poses, {}, robot);
}

inline AnnotationEvent annotation(AnnotationKind kind, const std::string& name, IslandId island,
                                  const std::vector<Eigen::Vector2d>& points) {
  AnnotationEvent event;
  event.kind = kind;
  event.name = name;
  event.island = island;
  event.max_speed_m_s = kind == AnnotationKind::speed ? 0.5 : 0;
  for (const Eigen::Vector2d& point : points) event.points.push_back({PatchId{}, point});
  return event;
}

inline bool on_any_map(PatchId) { return true; }

/// Where an annotation's points lie now.
inline std::vector<Eigen::Vector2d> placed(const Map& map, const AnnotationRecord& record) {
  std::vector<Eigen::Vector2d> points;
  for (const ManifoldPose& point : record.points) points.push_back(position(map.manifold().project(point)));
  return points;
}

}  // namespace isthmus::testing
