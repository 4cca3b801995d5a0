#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "patches/ids.hpp"

namespace isthmus {

/// A barcode that is fixed in the building, and where it is.
struct TagRecord {
  std::int32_t barcode = -1;
  IslandId island;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< in the island's frame
  Eigen::Matrix2d covariance =
      Eigen::Matrix2d::Zero();  ///< relative to the island's first patch; set by exports
  bool placed = false;
  PatchId patch;  ///< its patch on the map, a point; none while it is not placed
};

}  // namespace isthmus
