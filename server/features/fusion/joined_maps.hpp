#pragma once

#include "server/features/fusion/tie_filter.hpp"

namespace isthmus {

/// The joint state of both maps given the ties, but for the features of the second one that are marked as
/// gone, in the frame of the first: covariance P − WᵀW of what is kept, and what the second one's place adds.
/// One update of m rows at a cost of n² m / 2 for n errors that are kept, m n² / 2 at most for the second
/// map's being turned into the first one's axes. Robots, marks and features of the second follow those of the
/// first in their order; their ids begin at the first's next_id.
FeatureState joined_maps(const TiedMaps& maps, const TieFilter& ties, const std::vector<bool>& gone);

}  // namespace isthmus
