#include "tools/simulate/plan/clutter.hpp"

#include <algorithm>
#include <cmath>

#include "patches/pose.hpp"
#include "tools/simulate/plan/random.hpp"

namespace isthmus {
namespace {

bool clear_of(const std::vector<Eigen::Vector2d>& polygon, const std::vector<Segment>& ways,
              double clearance_m) {
  for (const Segment& way : ways) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Segment edge{polygon[i], polygon[(i + 1) % polygon.size()]};
      if (distance_m(edge, way) < clearance_m) return false;
    }
  }
  return true;
}

}  // namespace

std::vector<std::vector<Eigen::Vector2d>> strew(const Clutter& clutter, const Building& building,
                                                const std::vector<Segment>& ways) {
  std::vector<std::vector<Eigen::Vector2d>> polygons;
  const FloorPlan plan = build_floor_plan(building);
  Random random(building.seed, "clutter");
  for (int tries = 0; tries < 50 * clutter.count && static_cast<int>(polygons.size()) < clutter.count;
       ++tries) {
    const Eigen::Vector2d centre(random.uniform(plan.low.x(), plan.high.x()),
                                 random.uniform(plan.low.y(), plan.high.y()));
    const double width = random.uniform(clutter.size_min_m, clutter.size_max_m);
    const double depth = random.uniform(clutter.size_min_m, clutter.size_max_m);
    auto polygon = box(centre, width, depth, random.uniform(0, std::numbers::pi));
    if (clear_of(polygon, ways, clutter.clearance_m)) polygons.push_back(std::move(polygon));
  }
  return polygons;
}

std::vector<Eigen::Vector2d> box(const Eigen::Vector2d& centre, double width_m, double depth_m,
                                 double yaw_rad) {
  const Pose world_from_box{centre.x(), centre.y(), yaw_rad};
  const double x = 0.5 * width_m, y = 0.5 * depth_m;
  std::vector<Eigen::Vector2d> corners;
  for (const Eigen::Vector2d& corner :
       {Eigen::Vector2d(-x, -y), Eigen::Vector2d(x, -y), Eigen::Vector2d(x, y), Eigen::Vector2d(-x, y)}) {
    corners.push_back(world_from_box * corner);
  }
  return corners;
}

std::vector<Eigen::Vector2d> disc(const Eigen::Vector2d& centre, double radius_m, int corners) {
  std::vector<Eigen::Vector2d> ring;
  for (int i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    ring.push_back(centre + radius_m * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return ring;
}

}  // namespace isthmus
