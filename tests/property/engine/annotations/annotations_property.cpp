#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <numbers>

#include "server/engine/annotations/polygon_check.hpp"
#include "tests/property/drawn.hpp"
#include "tests/support/zones.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

double hundredths(int low, int high) { return 0.01 * *rc::gen::inRange(100 * low, 100 * high); }

/// A ring around a point: simple, whatever its radii.
std::vector<Eigen::Vector2d> any_ring() {
  const int corners = *rc::gen::inRange(3, 12);
  const Eigen::Vector2d middle(hundredths(0, 9), hundredths(-2, 2));
  std::vector<Eigen::Vector2d> ring;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    ring.emplace_back(middle + hundredths(1, 4) * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return ring;
}

struct AnyZone {
  Map map;
  std::vector<PatchId> line = add_line(map, 10);
  std::vector<Eigen::Vector2d> ring = any_ring();
  Annotations annotations;

  AnyZone() {
    RC_ASSERT(annotations.take(annotation(AnnotationKind::keep_out, "z", line.front(), ring), map,
                               on_any_map) == DropReason::none);
  }
  AnnotationRecord record() const { return annotations.records(map, on_any_map).front(); }
};

// A fit moves each patch by a little: the shape stays within that of what it was.
RC_GTEST_PROP(AnnotationsProperty, ShapeStaysWithTheMapUnderRefits, ()) {
  AnyZone zone;
  std::vector<Pose> fitted(zone.map.manifold().poses().begin(), zone.map.manifold().poses().end());
  const Pose moved{hundredths(-20, 20), hundredths(-20, 20), hundredths(-3, 3)};
  constexpr double most_m = 0.1, most_rad = 0.01, arm_m = 16;
  for (Pose& pose : fitted) {
    pose = moved * pose;
    pose.x += most_m * hundredths(-1, 1);
    pose.y += most_m * hundredths(-1, 1);
    pose.yaw += most_rad * hundredths(-1, 1);
  }
  zone.map.adopt(zone.line, fitted);
  const std::vector<Eigen::Vector2d> now = placed(zone.map, zone.record());
  for (std::size_t i = 0; i < now.size(); ++i)
    RC_ASSERT((now[i] - moved * zone.ring[i]).norm() <= 2 * most_m + most_rad * arm_m);
}

// Whichever relation goes, and wherever the parts are then: it is whole, on one island, and of the same
// shape.
RC_GTEST_PROP(AnnotationsProperty, ShapeStaysWhereTheIslandParts, ()) {
  AnyZone zone;
  const auto cut = static_cast<std::size_t>(*rc::gen::inRange(1, 10));
  zone.map.remove(zone.map.graph().between(zone.line[cut - 1], zone.line[cut]));
  zone.map.move_island(zone.line[cut], {hundredths(-50, 50), hundredths(-50, 50), hundredths(-3, 3)});
  zone.map.move_island(zone.line[0], {hundredths(-50, 50), hundredths(-50, 50), hundredths(-3, 3)});
  const AnnotationRecord record = zone.record();
  RC_ASSERT(!record.lost);
  for (const ManifoldPose& point : record.points)
    RC_ASSERT(zone.map.graph().island(point.patch) == record.island);
  const std::vector<Eigen::Vector2d> now = placed(zone.map, record);
  RC_ASSERT(std::abs(signed_area_m2(now) - signed_area_m2(zone.ring)) < 1e-6);
  for (std::size_t i = 1; i < now.size(); ++i)
    RC_ASSERT(std::abs((now[i] - now[0]).norm() - (zone.ring[i] - zone.ring[0]).norm()) < 1e-6);
}

}  // namespace
}  // namespace isthmus
