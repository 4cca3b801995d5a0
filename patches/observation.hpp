#pragma once

#include <vector>

#include "patches/polysolid.hpp"
#include "patches/star.hpp"

namespace isthmus {

/// How far a scan is trusted as free space, for patches, grids and coverage alike.
struct PatchOptions {
  NormalOptions normals;
  FreeSpaceOptions free_space;
};

/// What one scan shows, in the frame of the robot that took it: the new patch of Howard et al. 2006, IV-A,
/// step 1, before it is known whether the map keeps it. Made once for each scan; where the map is extended,
/// it becomes the patch.
struct Observation {
  Scan scan;
  Laser laser;
  std::vector<ScanPoint> points;  ///< hits, in metres, in order of beams
  Star star;                      ///< free space
};
Observation observe(Scan scan, const Laser& laser, const PatchOptions& options);

}  // namespace isthmus
