#pragma once

#include <tuple>
#include <vector>

#include "patches/patch.hpp"

namespace isthmus {

/// A patch as the robot's surroundings: that part of the manifold which is well determined with respect to
/// the robot's patch is projected on a plane (Howard et al. 2006, IV-A, step 2), here the plane of `local` =
/// the frame of the robot's patch.
struct LocalPatch {
  PatchPtr patch;
  Pose local_from_patch;

  auto members() { return std::tie(patch, local_from_patch); }
};

struct LocalMap {
  PatchId reference;  ///< whose frame `local` is
  std::vector<LocalPatch> patches;

  auto members() { return std::tie(reference, patches); }
};

}  // namespace isthmus
