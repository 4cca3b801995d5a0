#pragma once

#include <span>
#include <vector>

#include "server/output/grid/grid.hpp"
#include "server/paths/ground/cell.hpp"

namespace isthmus {

/// Where a robot stood the ground is free this far around its centre, unless something was hit there: lasers
/// of less than a full turn do not see it, and beams without return tell nothing.
inline constexpr double stood_m = 0.3;

/// What one patch shows as cells of its island, at its pose: free space in runs; hits, where robots stood,
/// and gaps between its beams, by columns.
class PatchRaster {
 public:
  /// Free cells of a row from `begin` to before `end`.
  struct Run {
    std::int32_t begin = 0;
    std::int32_t end = 0;
  };

  PatchRaster() = default;
  /// The patch must be on the grid (`is_on_grid`). `stood`: where robots stood besides its origin, in its
  /// frame.
  explicit PatchRaster(const PlacedPatch& placed, std::span<const Eigen::Vector2d> stood = {});

  const Pose& map_from_patch() const { return map_from_patch_; }
  Cell low() const { return low_; }    ///< of the rectangle that holds all of it
  Cell high() const { return high_; }  ///< one beyond

  /// Of a row, by columns; none outside.
  std::span<const Run> runs(std::int32_t row) const;
  std::span<const std::int32_t> hits(std::int32_t row) const { return hits_.row(row - low_.y); }
  /// Where robots stood, and gaps between beams (`find_beam_gaps`): free unless something was hit there.
  std::span<const std::int32_t> presumed(std::int32_t row) const { return presumed_.row(row - low_.y); }

 private:
  /// Columns by row, from `low`.
  struct Rows {
    std::vector<std::uint32_t> first{0};  // one more than there are rows
    std::vector<std::int32_t> columns;

    void end_row() { first.push_back(static_cast<std::uint32_t>(columns.size())); }
    std::span<const std::int32_t> row(std::int32_t number) const;
  };

  void presume(std::vector<Cell> cells);

  Pose map_from_patch_;
  Cell low_, high_;
  std::vector<std::uint32_t> first_run_{0};  // by row, one more than there are rows
  std::vector<Run> runs_;
  Rows hits_;
  Rows presumed_;
};

}  // namespace isthmus
