#include "patches/point_index.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace isthmus {
namespace {

// A single absurd point must not make the grid of tiles as large as its distance.
bool is_indexed(const ScanPoint& point) {
  return point.has_normal() && std::abs(point.position.x()) <= PointIndex::horizon_m &&
         std::abs(point.position.y()) <= PointIndex::horizon_m;
}

}  // namespace

PointIndex::PointIndex(std::span<const ScanPoint> points) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;
  for (const ScanPoint& point : points) {
    if (!is_indexed(point)) continue;
    low = low.cwiseMin(point.position);
    high = high.cwiseMax(point.position);
  }
  if (!(low.x() <= high.x())) return;
  origin_ = low - Eigen::Vector2d::Constant(reach_m);
  const Eigen::Vector2d extent = high - low + Eigen::Vector2d::Constant(2 * reach_m);
  tiles_x_ = static_cast<int>(extent.x() / tile_m) + 1;
  tiles_y_ = static_cast<int>(extent.y() / tile_m) + 1;
  tile_start_.assign(static_cast<std::size_t>(tiles_x_) * static_cast<std::size_t>(tiles_y_), -1);

  std::vector<float> squared_distance;  // of each cell's point from the cell's centre
  constexpr int span_cells = static_cast<int>(reach_m / cell_m) + 1;
  constexpr int tile_size = tile_cells * tile_cells;
  const auto count =
      static_cast<int>(std::min<std::size_t>(points.size(), std::numeric_limits<std::int16_t>::max()));
  for (int i = 0; i < count; ++i) {
    const ScanPoint& point = points[static_cast<std::size_t>(i)];
    if (!is_indexed(point)) continue;
    const Eigen::Vector2d local = point.position - origin_;
    const int cx = static_cast<int>(local.x() / cell_m);
    const int cy = static_cast<int>(local.y() / cell_m);
    for (int y = std::max(0, cy - span_cells); y <= std::min(tiles_y_ * tile_cells - 1, cy + span_cells);
         ++y) {
      for (int x = std::max(0, cx - span_cells); x <= std::min(tiles_x_ * tile_cells - 1, cx + span_cells);
           ++x) {
        const Eigen::Vector2d offset = Eigen::Vector2d((x + 0.5) * cell_m, (y + 0.5) * cell_m) - local;
        const auto squared = static_cast<float>(offset.squaredNorm());
        if (squared > reach_m * reach_m) continue;
        std::int32_t& start =
            tile_start_[static_cast<std::size_t>((y / tile_cells) * tiles_x_ + x / tile_cells)];
        if (start < 0) {
          start = static_cast<std::int32_t>(cells_.size());
          cells_.resize(cells_.size() + tile_size, -1);
          squared_distance.resize(cells_.size(), std::numeric_limits<float>::infinity());
        }
        const auto cell = static_cast<std::size_t>(start + (y % tile_cells) * tile_cells + x % tile_cells);
        if (squared < squared_distance[cell]) {
          squared_distance[cell] = squared;
          cells_[cell] = static_cast<std::int16_t>(i);
        }
      }
    }
  }
  cells_.shrink_to_fit();
}

int PointIndex::nearest(const Eigen::Vector2d& position) const {
  const double x = (position.x() - origin_.x()) / cell_m;
  const double y = (position.y() - origin_.y()) / cell_m;
  if (!(x >= 0 && y >= 0 && x < tiles_x_ * tile_cells && y < tiles_y_ * tile_cells)) return -1;
  const int cx = static_cast<int>(x);
  const int cy = static_cast<int>(y);
  const std::int32_t start =
      tile_start_[static_cast<std::size_t>((cy / tile_cells) * tiles_x_ + cx / tile_cells)];
  if (start < 0) return -1;
  return cells_[static_cast<std::size_t>(start + (cy % tile_cells) * tile_cells + cx % tile_cells)];
}

}  // namespace isthmus
