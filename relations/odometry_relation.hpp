#pragma once

#include <Eigen/LU>

#include "relations/relation.hpp"

namespace isthmus {

/// What odometry says of a patch as seen from the one before it, with the covariance of (x, y, yaw) in the
/// frame of that; not singular.
inline Relation odometry_relation(PatchId before, PatchId next, const Pose& before_from_next,
                                  const Eigen::Matrix3d& covariance) {
  Relation relation;
  relation.a = before;
  relation.b = next;
  relation.kind = RelationKind::odometry;
  relation.measurement = RelativePose{before_from_next, covariance.inverse()};
  relation.origin = {OriginKind::odometry, {}};
  return relation;
}

}  // namespace isthmus
