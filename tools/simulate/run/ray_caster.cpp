#include "tools/simulate/run/ray_caster.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace isthmus {
namespace {

using Eigen::Vector2d;

constexpr double max_cells = 4e6;

// Where from + t direction meets the segment, if ahead. A hair beyond the ends counts, so that no ray slips
// through a corner.
double ray_meets(const Vector2d& from, const Vector2d& direction, const Segment& segment) {
  const Vector2d along = segment.b - segment.a;
  const double denominator = direction.x() * along.y() - direction.y() * along.x();
  if (std::abs(denominator) < 1e-14) return no_hit_m;
  const Vector2d to_a = segment.a - from;
  const double t = (to_a.x() * along.y() - to_a.y() * along.x()) / denominator;
  const double share = (to_a.x() * direction.y() - to_a.y() * direction.x()) / denominator;
  return t >= 0 && share >= -1e-9 && share <= 1 + 1e-9 ? t : no_hit_m;
}

double incidence(const Vector2d& direction, const Segment& segment) {
  const Vector2d along = (segment.b - segment.a).normalized();
  return std::asin(std::min(1.0, std::abs(direction.dot(along))));
}

// The part [enter, leave] of the ray inside a box; empty where enter > leave.
std::array<double, 2> clip(const Vector2d& from, const Vector2d& direction, const Vector2d& low,
                           const Vector2d& high, double reach) {
  double enter = 0, leave = reach;
  for (int axis = 0; axis < 2; ++axis) {
    if (std::abs(direction[axis]) < 1e-15) {
      if (from[axis] < low[axis] || from[axis] > high[axis]) return {1, 0};
      continue;
    }
    const double t1 = (low[axis] - from[axis]) / direction[axis];
    const double t2 = (high[axis] - from[axis]) / direction[axis];
    enter = std::max(enter, std::min(t1, t2));
    leave = std::min(leave, std::max(t1, t2));
  }
  return {enter, leave};
}

struct CellGrid {
  Vector2d low;
  double cell_m;
  std::array<int, 2> count;
};

// Along a ray from cell to cell; distances are along the ray from its beginning.
struct CellWalk {
  CellWalk(const Vector2d& from, const Vector2d& direction, double enter, const CellGrid& grid) {
    const Vector2d start = from + enter * direction;
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const auto i = static_cast<Eigen::Index>(axis);
      cell[axis] =
          std::clamp(static_cast<int>((start[i] - grid.low[i]) / grid.cell_m), 0, grid.count[axis] - 1);
      step[axis] = direction[i] > 0 ? 1 : -1;
      const bool still = std::abs(direction[i]) < 1e-15;
      const double at = grid.low[i] + grid.cell_m * (cell[axis] + (step[axis] > 0 ? 1 : 0));
      next[axis] = still ? no_hit_m : (at - from[i]) / direction[i];
      stride[axis] = still ? no_hit_m : grid.cell_m / std::abs(direction[i]);
    }
  }

  std::size_t axis() const { return next[0] < next[1] ? 0 : 1; }
  double border() const { return next[axis()]; }
  // False: that was the grid's last.
  bool step_on(const std::array<int, 2>& count) {
    const std::size_t along = axis();
    cell[along] += step[along];
    if (cell[along] < 0 || cell[along] >= count[along]) return false;
    next[along] += stride[along];
    return true;
  }

  std::array<int, 2> cell{}, step{};
  std::array<double, 2> next{}, stride{};
};

}  // namespace

RayCaster::RayCaster(const FloorPlan& plan, double cell_m) : segments_(plan.segments) {
  const Vector2d margin = Vector2d::Constant(1e-6);
  low_ = plan.low - margin;
  const Vector2d size = plan.high + margin - low_;
  cell_m_ = std::max(cell_m, std::sqrt(size.x() * size.y() / max_cells));
  columns_ = std::max(1, static_cast<int>(std::ceil(size.x() / cell_m_)));
  rows_ = std::max(1, static_cast<int>(std::ceil(size.y() / cell_m_)));

  std::vector<std::vector<std::uint32_t>> cells(static_cast<std::size_t>(columns_) *
                                                static_cast<std::size_t>(rows_));
  const double half_diagonal = cell_m_ * 0.7072;
  for (std::uint32_t s = 0; s < segments_.size(); ++s) {
    const Segment& segment = segments_[s];
    const Vector2d first = (segment.a.cwiseMin(segment.b) - low_) / cell_m_;
    const Vector2d last = (segment.a.cwiseMax(segment.b) - low_) / cell_m_;
    for (int y = std::max(0, static_cast<int>(first.y() - 1e-6));
         y <= std::min(rows_ - 1, static_cast<int>(last.y() + 1e-6)); ++y) {
      for (int x = std::max(0, static_cast<int>(first.x() - 1e-6));
           x <= std::min(columns_ - 1, static_cast<int>(last.x() + 1e-6)); ++x) {
        const Vector2d middle = low_ + cell_m_ * Vector2d(x + 0.5, y + 0.5);
        if (distance_m(middle, segment) > half_diagonal) continue;
        cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x)]
            .push_back(s);
      }
    }
  }
  cell_start_.push_back(0);
  for (const auto& cell : cells) {
    cell_segments_.insert(cell_segments_.end(), cell.begin(), cell.end());
    cell_start_.push_back(static_cast<std::uint32_t>(cell_segments_.size()));
  }
}

// Amanatides and Woo's walk through the cells along the ray; it ends at the first cell that holds a hit.
std::optional<RayHit> RayCaster::cast(const Vector2d& from, const Vector2d& direction, double reach_m) const {
  if (segments_.empty()) return std::nullopt;
  const Vector2d high = low_ + cell_m_ * Vector2d(columns_, rows_);
  const auto [enter, leave] = clip(from, direction, low_, high, reach_m);
  if (enter > leave) return std::nullopt;

  const std::array<int, 2> count = {columns_, rows_};
  CellWalk walk(from, direction, enter, {low_, cell_m_, count});
  double best = no_hit_m;
  const Segment* surface = nullptr;
  while (true) {
    const std::size_t index = static_cast<std::size_t>(walk.cell[1]) * static_cast<std::size_t>(columns_) +
                              static_cast<std::size_t>(walk.cell[0]);
    for (std::uint32_t k = cell_start_[index]; k < cell_start_[index + 1]; ++k) {
      const Segment& segment = segments_[cell_segments_[k]];
      const double t = ray_meets(from, direction, segment);
      if (t < best) {
        best = t;
        surface = &segment;
      }
    }
    const double border = walk.border();
    if (best <= border || border > leave || !walk.step_on(count)) break;
  }
  if (surface == nullptr || best > reach_m) return std::nullopt;
  return RayHit{best, incidence(direction, *surface), surface->return_limit_rad};
}

bool RayCaster::line_of_sight(const Vector2d& from, const Vector2d& to) const {
  const double distance = (to - from).norm();
  return distance < 1e-9 || !cast(from, (to - from) / distance, distance).has_value();
}

bool RayCaster::touches(const Vector2d& point, double radius_m) const {
  const Vector2d first = (point - low_).array() / cell_m_ - radius_m / cell_m_;
  const Vector2d last = (point - low_).array() / cell_m_ + radius_m / cell_m_;
  for (int y = std::max(0, static_cast<int>(std::floor(first.y())));
       y <= std::min(rows_ - 1, static_cast<int>(std::floor(last.y()))); ++y) {
    for (int x = std::max(0, static_cast<int>(std::floor(first.x())));
         x <= std::min(columns_ - 1, static_cast<int>(std::floor(last.x()))); ++x) {
      const std::size_t index =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(x);
      for (std::uint32_t k = cell_start_[index]; k < cell_start_[index + 1]; ++k) {
        if (distance_m(point, segments_[cell_segments_[k]]) < radius_m) return true;
      }
    }
  }
  return false;
}

}  // namespace isthmus
