#pragma once

#include <cstdint>
#include <vector>

#include "server/paths/ground/cell.hpp"
#include "server/paths/roads/point_graph.hpp"

namespace isthmus {

/// Squares of a roadmap joined to regions of 80 cm a side, over which a search first goes roughly: from each
/// square of a region one comes to each other one within it. Never changed.
class Regions {
 public:
  Regions() = default;
  /// `middles`: a cell of each square. `squares`: which is beside which.
  Regions(const std::vector<Cell>& middles, const PointGraph& squares);

  std::int32_t of(std::int32_t square) const { return region_[static_cast<std::size_t>(square)]; }

  /// By region, about what is left from there to the goal, in metres, at most 8 % more than it is; infinity
  /// where no way leads through that is not much longer than the shortest. Empty where there is no way. A
  /// search that keeps to these regions finds what is worth finding.
  std::vector<float> left_m(std::int32_t from_square, std::int32_t to_square) const;

  /// By region, how long about the shortest way from a square is, in metres; infinity where there is none.
  std::vector<float> lengths_from(std::int32_t square) const { return graph_.lengths_from(of(square)); }

 private:
  std::vector<std::int32_t> region_;  // by square
  PointGraph graph_;
};

}  // namespace isthmus
