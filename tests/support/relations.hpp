#pragma once

#include "relations/relation.hpp"

namespace isthmus::testing {

/// Odometry of a metre ahead, of unit information: what ties two patches together where no figures matter.
inline Relation odometry_between(int a, int b) {
  Relation relation;
  relation.a = PatchId{a};
  relation.b = PatchId{b};
  relation.kind = RelationKind::odometry;
  relation.measurement = RelativePose{{1, 0, 0}, Eigen::Matrix3d::Identity()};
  return relation;
}

}  // namespace isthmus::testing
