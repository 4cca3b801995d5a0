#pragma once

#include <memory>
#include <string>

#include "patches/ids.hpp"
#include "patches/observation.hpp"
#include "patches/point_index.hpp"

namespace isthmus {

/// A patch of the manifold (Howard et al. 2006, III-A): the free space and the points of one scan, in the
/// frame of the robot that took it. Immutable and shared; its projected pose is kept apart, in the Manifold,
/// and is all that a fit changes.
struct Patch : Observation {
  PatchId id;
  std::string robot;  ///< who saw it
  std::int64_t utime = 0;
  PointIndex index;  ///< nearest of `points`
  Polysolid free_space;
  std::int32_t tag = -1;  ///< the barcode of a fixed tag: a patch that is but a point; negative: none
};

using PatchPtr = std::shared_ptr<const Patch>;

PatchPtr make_patch(PatchId id, std::string robot, Observation observation, const PatchOptions& options);
/// The same of a scan that has not been looked at yet.
PatchPtr make_patch(PatchId id, std::string robot, const Scan& scan, const Laser& laser,
                    const PatchOptions& options);

}  // namespace isthmus
