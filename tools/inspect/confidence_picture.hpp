#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>

#include "relations/graph.hpp"
#include "server/output/grid/grid.hpp"
#include "server/output/pictures/map_sheet.hpp"

namespace isthmus {

/// An island of a map as a picture of confidence shows it.
struct ConfidenceMap {
  const RelationGraph& graph;
  std::span<const Pose> poses;       ///< by patch id
  std::span<const PatchId> patches;  ///< of the island, without tags
  const OccupancyGrid& grid;
  int island = -1;              ///< K
  std::int64_t from_utime = 0;  ///< of its patches
  std::int64_t to_utime = 0;
};

/// Which patches and island, when, and what is known of one patch relative to the other: `covariance` in the
/// frame of a, and how far the ellipse of 95 % reaches.
SheetText confidence_sheet_text(const ConfidenceMap& map, PatchId a, PatchId b,
                                const Eigen::Matrix3d& covariance, double longest_m);

/// How many times ellipses of up to `longest_m` are enlarged, so that they are seen on a map `map_m` long: a
/// round number, at least 1.
double enlargement(double longest_m, double map_m);

/// Draws in what ellipse each patch lies with 95 %, relative to patch a (exact, over the whole island); patch
/// b stands out. They are enlarged by a round number, which the legend tells. Of a large island some of the
/// patches, evenly. Throws std::runtime_error where the file cannot be written or a patch is not determined.
void write_confidence_picture(const ConfidenceMap& map, PatchId a, PatchId b, const std::string& path);

}  // namespace isthmus
