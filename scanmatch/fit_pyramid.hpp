#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "scanmatch/correlative.hpp"

namespace isthmus {

/// How well a beam's end fits each cell of a grid over points of a map, 0 to 255, and for each level the
/// maximum over the 2^level x 2^level cells to the upper right: a bound for every shift within that block
/// (Hess et al. 2016, eq. 11). A margin of the widest block's width is all 0, so that no shift of a beam that
/// ends in the box leads out of the grid.
class FitPyramid {
 public:
  /// Over the box from `low` to `high`, in the map's frame; points outside count for nothing.
  FitPyramid(std::span<const Eigen::Vector2d> map, const Eigen::Vector2d& low, const Eigen::Vector2d& high,
             const CorrelativeOptions& options, int levels);

  /// Index of the cell that a beam ends in; it moves by `step` for a shift in cells.
  std::ptrdiff_t cell(const Eigen::Vector2d& end) const { return index(cell_x(end.x()), cell_y(end.y())); }
  std::ptrdiff_t step(int x, int y) const { return static_cast<std::ptrdiff_t>(y) * width_ + x; }
  const std::uint8_t* level(int level) const { return all(level).data(); }
  /// All of a level, row by row.
  std::span<const std::uint8_t> all(int level) const { return levels_[static_cast<std::size_t>(level)]; }

 private:
  int cell_x(double x) const { return static_cast<int>(std::floor((x - origin_.x()) / cell_m_)); }
  int cell_y(double y) const { return static_cast<int>(std::floor((y - origin_.y()) / cell_m_)); }
  std::ptrdiff_t index(int x, int y) const { return step(x + margin_, y + margin_); }
  void stamp(const Eigen::Vector2d& position, int blur, double blur_m);
  std::vector<std::uint8_t> widened(const std::vector<std::uint8_t>& below, int shift) const;

  double cell_m_;
  int margin_;
  Eigen::Vector2d origin_;
  int columns_;
  int rows_;
  int width_;
  std::vector<std::vector<std::uint8_t>> levels_;
  std::vector<double> falls_x_;
};

}  // namespace isthmus
