#pragma once

#include <optional>
#include <span>
#include <vector>

#include "patches/ids.hpp"

namespace isthmus {

/// A relation between two patches that may be wrong.
struct UncertainLink {
  RelationId relation;
  PatchId a;
  PatchId b;
  double log_odds = 0;      ///< that it is right
  bool of_placing = false;  ///< b was placed by it and by its other links of this kind: wrong by one mistake
};

/// What would have to be wrong for patches to lie otherwise than all relations together say: the links that
/// part them, least sure in sum.
struct WeakestCut {
  double log_odds = 0;                ///< that it is not so: of each mistake that is needed, summed
  std::vector<RelationId> relations;  ///< that are parted, by id
  std::vector<PatchId> beyond;        ///< the patches on the side of `to`, by id
};

/// The minimum cut between two sets of patches (Boykov and Kolmogorov, 2004, "An experimental comparison of
/// min-cut/max-flow algorithms"). A placing is one node more, between the patch and those that it was placed
/// by: cutting it costs what the least sure of
/// its links does, however many it left. Nothing where the sets share a patch or are not
/// connected.
std::optional<WeakestCut> weakest_cut(std::span<const UncertainLink> links, std::span<const PatchId> from,
                                      std::span<const PatchId> to);

}  // namespace isthmus
