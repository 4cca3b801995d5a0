#pragma once

#include <cstdint>
#include <vector>

#include "server/output/grid/grid.hpp"
#include "server/paths/ground/cell.hpp"
#include "server/paths/roads/roadmap.hpp"

namespace isthmus {

/// Shortest ways over a grid as it is written, for judging a planner that knows nothing of it: by steps to
/// the 48 neighbours within four cells that no other lies before, at most 0.8 % longer than the shortest. The
/// grid has the resolution of the ground.
class GridOptimum {
 public:
  GridOptimum(const OccupancyGrid& grid, const Footprint& footprint);

  const std::vector<Cell>& room() const { return room_; }  ///< where the footprint fits
  bool has_room(const Cell& cell) const;
  bool is_occupied(const Cell& cell) const;
  /// Whether an occupied cell reaches nearer to a point than this, in metres.
  bool is_near_wall(const Eigen::Vector2d& point, double distance_m) const;

  /// Lengths of the ways from a cell with room, in metres.
  void start_from(const Cell& cell);
  /// Infinity where there is no way.
  double length_m(const Cell& to) const;

 private:
  bool has(const Cell& cell) const;
  std::size_t index(const Cell& cell) const;

  Cell low_;
  int width_ = 0;
  int height_ = 0;
  std::vector<std::uint8_t> occupied_;
  std::vector<float> wall_cells_;  ///< from centre to centre
  std::vector<std::uint8_t> has_room_;
  std::vector<Cell> room_;
  std::vector<float> length_m_;
};

}  // namespace isthmus
