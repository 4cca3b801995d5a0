#pragma once

#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "server/feature_maps/feature_map_options.hpp"
#include "server/features/feature_filter.hpp"
#include "server/features/fusion/fusion.hpp"

namespace isthmus {

/// One map of features and the robots on it.
struct Team {
  FeatureFilter filter;
  std::vector<int> journeys;              ///< by the filter's index of a robot
  std::map<std::int32_t, int> landmarks;  ///< feature ids of fixed barcodes

  auto members() { return std::tie(filter, journeys, landmarks); }
};

/// The second map in the frame of the first.
struct JoinedTeams {
  FeatureState state;
  Pose one_from_two;                          ///< between the maps' frames
  std::vector<Fusion::Duplicate> duplicates;  ///< ids in `state`, which those that are gone are not in
};

/// By a meeting of two robots, duplicates found by the fusion.
JoinedTeams joined_at_meeting(const Team& one, PoseOwner robot_1, const Team& two, PoseOwner robot_2,
                              const RobotAlignment& alignment, const FusionOptions& options);

/// By features that are one in both, by indices, at about that placing. Nothing where they do not tell.
std::optional<JoinedTeams> joined_by_twins(const Team& one, const Team& two, const Pose& one_from_two,
                                           std::span<const TwinSeed> twins, const FusionOptions& options);

/// By barcodes that both know: the least-squares alignment of them is where the maps are put, and says
/// nothing itself; then that each two are one is measured. Nothing where there are fewer than `min_common`,
/// or where they disagree at the probability.
std::optional<JoinedTeams> joined_by_landmarks(const Team& one, const Team& two, std::size_t min_common,
                                               double probability);

}  // namespace isthmus
