#pragma once

#include <memory>
#include <string>
#include <vector>

#include "patches/ids.hpp"
#include "patches/point_index.hpp"
#include "patches/polysolid.hpp"
#include "patches/star.hpp"

namespace isthmus {

/// A patch of the manifold (Howard et al. 2006, III-A): the free space and the points of one scan, in the
/// frame of the robot that took it. Immutable and shared; its projected pose is kept apart, in the Manifold,
/// and is all that a fit changes.
struct Patch {
  PatchId id;
  std::string robot;  ///< who saw it
  std::int64_t utime = 0;
  Scan scan;
  Laser laser;
  std::vector<ScanPoint> points;
  PointIndex index;  ///< nearest of `points`
  Star star;
  Polysolid free_space;
  std::int32_t tag = -1;  ///< the barcode of a fixed tag: a patch that is but a point; negative: none
};

using PatchPtr = std::shared_ptr<const Patch>;

/// How far a scan is trusted as free space, for patches, grids and coverage alike.
struct PatchOptions {
  NormalOptions normals;
  FreeSpaceOptions free_space;
};

PatchPtr make_patch(PatchId id, std::string robot, const Scan& scan, const Laser& laser,
                    const PatchOptions& options);

}  // namespace isthmus
