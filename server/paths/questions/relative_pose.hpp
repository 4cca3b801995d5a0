#pragma once

#include <string>
#include <vector>

#include "server/engine/record/map_copy.hpp"
#include "server/paths/questions/path.hpp"

namespace isthmus {

/// Something on the manifold, and how surely it lies there.
struct PlacedObject {
  ManifoldPose pose;
  /// Of (x, y, yaw) of patch_from_object, relative to the patch.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  std::string robot = {};  ///< whose laser says that it is there, and not another's; empty: no one's
};

/// Where one thing is as seen from another.
struct RelativePoseAnswer {
  Refusal refusal = Refusal::none;
  Pose a_from_b;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of (x, y, yaw) of a_from_b, in a's frame
  /// Of all ways along relations from a's patch to b's, that of least variance of position: what the answer
  /// rests on before all. Empty where both are in one patch.
  std::vector<RelationId> chain;
};

/// The covariance is that of all the island's relations between the two patches (Howard et al. 2006, III-C),
/// with those of both objects, and what the mounts of the lasers may be off by (relations/mount_survey.hpp).
/// Refused: unknown_patch, other_island, bad_value, undetermined.
RelativePoseAnswer relative_pose(const MapCopy& map, const PlacedObject& a, const PlacedObject& b);

/// Why a pose is none on a map, or none: unknown_patch, bad_value.
Refusal check(const MapCopy& map, const ManifoldPose& pose);

}  // namespace isthmus
