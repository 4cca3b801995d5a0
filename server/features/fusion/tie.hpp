#pragma once

#include <optional>

#include "server/features/fusion/rendezvous.hpp"

namespace isthmus {

/// n by 3, n at most 4: by the second map's place in the first.
using ByMaps = Eigen::Matrix<double, Eigen::Dynamic, 3, 0, 4, 3>;

/// Two maps, each in its frame with errors of its own, and where the second one's frame lies in the first
/// one's. That errs by (x, y, yaw) in the first one's axes, a turn of all about `about`: near what ties the
/// maps together, so that a turn moves little there.
struct TiedMaps {
  const FeatureState& one;
  const FeatureState& two;
  Pose one_from_two;
  Eigen::Vector2d about = Eigen::Vector2d::Zero();
  Eigen::Vector2d seen_from =
      Eigen::Vector2d::Zero();  ///< where the robot stands that measured the range to there

  /// With the second map moved by such an error.
  Pose moved(const Eigen::Vector3d& delta) const;
};

/// What ties two maps together, linear in the errors of both and of where the second one lies: residual =
/// by_one e₁ + by_two e₂ + by_maps e_T + noise.
struct MapTie {
  LocalVector residual;
  LocalMatrix noise;
  int offset_one = 0;
  int offset_two = 0;
  LocalMatrix by_one;
  LocalMatrix by_two;
  ByMaps by_maps;
};

/// That the robots saw one another: range and both bearings where that is what was measured, for the place of
/// the one in the frame of the other lies on an arc, 0.1 m off its tangent at 4 m and three sigmas of 0.07
/// rad; else (x, y, yaw).
MapTie tie_robots(const TiedMaps& maps, PoseOwner robot_1, PoseOwner robot_2,
                  const RobotAlignment& alignment);

/// That two features are one (Zhou and Roumeliotis 2006, eq. 20): measure_identity before the maps are one.
/// Nothing where the kinds differ or the two face opposite sides.
std::optional<MapTie> tie_features(const TiedMaps& maps, std::size_t in_one, std::size_t in_two,
                                   double sigma_m);

}  // namespace isthmus
