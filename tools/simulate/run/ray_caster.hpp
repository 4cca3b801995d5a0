#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "tools/simulate/plan/floor_plan.hpp"

namespace isthmus {

/// The range of a ray that meets nothing.
inline constexpr double no_hit_m = std::numeric_limits<double>::infinity();

/// Where a ray first meets a surface.
struct RayHit {
  double range_m = 0;
  double incidence_rad = 0;     ///< between the ray and the surface's normal, 0 to pi/2
  double return_limit_rad = 0;  ///< the surface's
};

/// Casts rays in a floor plan, by a grid of cells that know the segments passing through them.
class RayCaster {
 public:
  static constexpr double default_cell_m = 1.0;

  explicit RayCaster(const FloorPlan& plan, double cell_m = default_cell_m);

  /// The first surface along a unit direction, no farther than reach_m.
  std::optional<RayHit> cast(const Eigen::Vector2d& from, const Eigen::Vector2d& direction,
                             double reach_m) const;

  /// Whether nothing stands between two points.
  bool line_of_sight(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;

  /// Whether a surface lies within radius_m of the point.
  bool touches(const Eigen::Vector2d& point, double radius_m) const;

 private:
  std::vector<Segment> segments_;
  Eigen::Vector2d low_ = Eigen::Vector2d::Zero();
  double cell_m_ = default_cell_m;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::uint32_t> cell_start_;  ///< offsets into cell_segments_, one more than there are cells
  std::vector<std::uint32_t> cell_segments_;
};

}  // namespace isthmus
