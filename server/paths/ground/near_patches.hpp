#pragma once

#include <span>
#include <utility>
#include <vector>

#include "server/engine/record/map_copy.hpp"
#include "server/paths/ground/no_way.hpp"

namespace isthmus {

/// How far patches are from one another along relations: the least sum of the distances between the origins
/// of related patches, in metres. It bounds what two patches of one island can have drifted apart, and stands
/// for eq. 12 of Howard et al. 2006 where every pair of patches is asked about.
class NearPatches {
 public:
  NearPatches() = default;
  /// Ways of at most `reach_m` are known.
  NearPatches(const MapCopy& map, double reach_m);

  /// no_way_m where it is more than the reach, and for patches that are not there.
  float way_m(PatchId a, PatchId b) const;
  bool near(PatchId a, PatchId b) const { return way_m(a, b) < no_way_m; }

 private:
  std::vector<std::vector<std::pair<PatchId, float>>> near_;  // by patch id; each by id
};

}  // namespace isthmus
