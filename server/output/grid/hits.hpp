#pragma once

#include <cstdint>
#include <vector>

#include "patches/patch.hpp"
#include "server/output/grid/lattice.hpp"

namespace isthmus {

/// Whether a patch's hit lies within the range at which its free space is cut: hits beyond are as little
/// trusted as the space before them.
bool within_free_space_range(const Patch& patch, const ScanPoint& point);

/// For each cell, how many patches have a hit in it, or a wall there between two neighbouring hits.
/// What lies beyond the lattice is left out.
class Hits {
 public:
  explicit Hits(const Lattice& lattice) : lattice_(lattice), counts_(lattice.size()) {}

  void add(const Patch& patch, const Pose& map_from_patch);

  int count(int column, int row) const { return counts_[lattice_.index(column, row)]; }

 private:
  void touch(const Eigen::Vector2d& map_point);
  void touch_between(const Eigen::Vector2d& map_from, const Eigen::Vector2d& map_to);

  Lattice lattice_;
  std::vector<std::uint16_t> counts_;
  std::vector<std::size_t> touched_;  ///< cells of the patch at hand
};

}  // namespace isthmus
