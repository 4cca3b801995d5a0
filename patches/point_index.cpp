#include "patches/point_index.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace isthmus {
namespace {

// A single absurd point must not make the grid of tiles as large as its distance.
bool is_indexed(const ScanPoint& point) {
  return point.has_normal() && std::abs(point.position.x()) <= PointIndex::horizon_m &&
         std::abs(point.position.y()) <= PointIndex::horizon_m;
}

/// What holds all points that are indexed; empty where none is.
Eigen::AlignedBox2d box_of(std::span<const ScanPoint> points) {
  Eigen::AlignedBox2d box;
  for (const ScanPoint& point : points)
    if (is_indexed(point)) box.extend(point.position);
  return box;
}

/// Enters points into cells; a tile gets its cells with the first point that is near.
template <int tile_cells>
class TileFiller {
 public:
  TileFiller(int tiles_x, int tiles_y, std::vector<std::int32_t>& tile_start,
             std::vector<std::int16_t>& cells)
      : tiles_x_(tiles_x),
        end_x_(tiles_x * tile_cells),
        end_y_(tiles_y * tile_cells),
        tile_start_(tile_start),
        cells_(cells) {}

  /// To the cells in reach that no other point is nearer to; `local` from the tiles' corner.
  void add(std::int16_t point, const Eigen::Vector2d& local) {
    constexpr double cell_m = PointIndex::cell_m, reach_m = PointIndex::reach_m;
    constexpr int span_cells = static_cast<int>(reach_m / cell_m) + 1;
    const int cx = static_cast<int>(local.x() / cell_m);
    const int cy = static_cast<int>(local.y() / cell_m);
    for (int y = std::max(0, cy - span_cells); y <= std::min(end_y_ - 1, cy + span_cells); ++y) {
      for (int x = std::max(0, cx - span_cells); x <= std::min(end_x_ - 1, cx + span_cells); ++x) {
        const Eigen::Vector2d offset = Eigen::Vector2d((x + 0.5) * cell_m, (y + 0.5) * cell_m) - local;
        const auto squared = static_cast<float>(offset.squaredNorm());
        if (squared > reach_m * reach_m) continue;
        const std::size_t cell = cell_at(x, y);
        if (squared >= squared_distance_[cell]) continue;
        squared_distance_[cell] = squared;
        cells_[cell] = point;
      }
    }
  }

 private:
  std::size_t cell_at(int x, int y) {
    const int tile = (y / tile_cells) * tiles_x_ + x / tile_cells;
    std::int32_t& start = tile_start_[static_cast<std::size_t>(tile)];
    if (start < 0) {
      start = static_cast<std::int32_t>(cells_.size());
      cells_.resize(cells_.size() + tile_cells * tile_cells, -1);
      squared_distance_.resize(cells_.size(), std::numeric_limits<float>::infinity());
    }
    const int cell = start + (y % tile_cells) * tile_cells + x % tile_cells;
    return static_cast<std::size_t>(cell);
  }

  int tiles_x_;
  int end_x_;
  int end_y_;
  std::vector<std::int32_t>& tile_start_;
  std::vector<std::int16_t>& cells_;
  std::vector<float> squared_distance_;  // of each cell's point from the cell's centre
};

}  // namespace

PointIndex::PointIndex(std::span<const ScanPoint> points) {
  const Eigen::AlignedBox2d box = box_of(points);
  if (box.isEmpty()) return;
  origin_ = box.min() - Eigen::Vector2d::Constant(reach_m);
  const Eigen::Vector2d extent = box.max() - box.min() + Eigen::Vector2d::Constant(2 * reach_m);
  tiles_x_ = static_cast<int>(extent.x() / tile_m) + 1;
  tiles_y_ = static_cast<int>(extent.y() / tile_m) + 1;
  tile_start_.assign(static_cast<std::size_t>(tiles_x_) * static_cast<std::size_t>(tiles_y_), -1);
  TileFiller<tile_cells> filler(tiles_x_, tiles_y_, tile_start_, cells_);
  const std::size_t count = std::min<std::size_t>(points.size(), std::numeric_limits<std::int16_t>::max());
  for (std::size_t i = 0; i < count; ++i)
    if (is_indexed(points[i])) filler.add(static_cast<std::int16_t>(i), points[i].position - origin_);
  cells_.shrink_to_fit();
}

int PointIndex::nearest(const Eigen::Vector2d& position) const {
  const double x = (position.x() - origin_.x()) / cell_m;
  const double y = (position.y() - origin_.y()) / cell_m;
  if (!(x >= 0 && y >= 0 && x < tiles_x_ * tile_cells && y < tiles_y_ * tile_cells)) return -1;
  const int cx = static_cast<int>(x);
  const int cy = static_cast<int>(y);
  const int tile = (cy / tile_cells) * tiles_x_ + cx / tile_cells;
  const std::int32_t start = tile_start_[static_cast<std::size_t>(tile)];
  if (start < 0) return -1;
  const int cell = start + (cy % tile_cells) * tile_cells + cx % tile_cells;
  return cells_[static_cast<std::size_t>(cell)];
}

}  // namespace isthmus
