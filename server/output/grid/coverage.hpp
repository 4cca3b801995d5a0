#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "patches/patch.hpp"
#include "server/output/grid/lattice.hpp"

namespace isthmus {

/// For each cell, how many patches' free spaces contain its centre. Each edge of a ring adds its direction to
/// all cells to its right; as rings are simple and holes turn the other way, that sums to one inside and zero
/// outside. Only the steps are kept, row by row, so the work grows with the outline and not with the area.
class Coverage {
 public:
  explicit Coverage(const Lattice& lattice) : lattice_(lattice), steps_(lattice.size()) {}

  void add(const Polysolid& free_space, const Pose& map_from_patch);

  /// The count of a cell is the sum of its row's steps up to and with it.
  std::span<const std::int32_t> steps_of_row(int row) const {
    return {steps_.data() + lattice_.index(0, row), static_cast<std::size_t>(lattice_.width)};
  }

 private:
  void add_ring(const Ring& ring, const Pose& map_from_patch);
  void add_edge(const Eigen::Vector2d& from_cells, const Eigen::Vector2d& to_cells);

  Lattice lattice_;
  std::vector<std::int32_t> steps_;
};

}  // namespace isthmus
