#pragma once

#include <span>
#include <vector>

#include "server/feature_maps/ways/stop.hpp"
#include "server/features/state/state.hpp"

namespace isthmus {

/// Where robots of one map were at their stops, by the map as it is now: the poses (map_from_robot) of least
/// squares given its features, what the robots saw of them and of one another, and their steps from stop to
/// stop. A filter knows where a robot was only as of then, and a loop that closes later moves the features
/// and not the way; the map is taken as it is, so that ways are chains, and cost what they are long. What a
/// view errs by is robust (Cauchy), for a wall may have been taken for another. As the filter had them where
/// the equations have no solution.
///
/// `map`: of its state robots and features are looked at, not the covariance.
std::vector<std::vector<Pose>> smoothed_stops(std::span<const std::span<const Stop>> ways,
                                              const FeatureState& map);

}  // namespace isthmus
