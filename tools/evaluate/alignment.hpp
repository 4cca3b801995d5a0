#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "tools/evaluate/relation_error.hpp"
#include "tools/evaluate/tags.hpp"
#include "tools/evaluate/trajectories.hpp"

namespace isthmus {

/// The same moment in the truth and in the estimate.
struct PosePair {
  Pose truth_from_robot;
  Pose map_from_robot;
  std::int64_t utime = 0;  ///< of the truth
};

/// truth_from_map: the rigid motion of least squared distance between positions (Umeyama, PAMI 13, 1991, in
/// the plane and without scale).
Pose align(std::span<const PosePair> pairs);

/// How far poses are from the truth, after the island as a whole has been moved onto it.
struct PoseErrors {
  std::size_t count = 0;
  Statistics translation_m;
  Statistics rotation_deg;
};

/// One island's poses and fixed tags after one rigid motion for all robots together, found from the robots'
/// positions alone.
struct IslandErrors {
  int island = 0;
  Pose truth_from_map;
  std::map<std::string, PoseErrors> robots;
  PoseErrors team;  ///< of all robots' poses together
  Statistics tag_translation_m;
  std::size_t tags = 0;                                ///< compared
  std::map<std::string, std::vector<PosePair>> pairs;  ///< what was compared, by robot
};

/// What a team's map is worth against the truth.
struct AbsoluteErrors {
  std::vector<IslandErrors> islands;
  std::map<std::string, std::size_t> missing;  ///< by robot: stamps of the truth without a pose
  std::size_t missing_tags = 0;                ///< true tags that no compared island has
};

struct TagsToCompare {
  std::map<std::int32_t, Eigen::Vector2d> truth;
  std::map<std::int32_t, PlacedTag> map;
};

/// Compares poses and truth at nearest stamps within 0.1 s. Where several stamps of the truth are nearest to
/// the same pose, the nearest of them counts: the truth may come at a higher rate.
AbsoluteErrors evaluate_absolute(const std::map<std::string, Trajectory>& truth, const TeamTrajectories& team,
                                 const TagsToCompare& tags = {});

}  // namespace isthmus
