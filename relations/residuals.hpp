#pragma once

#include "relations/relation.hpp"

namespace isthmus {

/// The residuals e of one measurement, whitened (unit variance each), at a pose of b in a, and their
/// derivatives. `rows` of them are in use: 5 for Correspondences, 3 for RelativePose, 1 for Range and
/// Bearing.
struct LinearResidual {
  int rows = 0;
  Eigen::Matrix<double, 5, 1> e = Eigen::Matrix<double, 5, 1>::Zero();
  Eigen::Matrix<double, 5, 3> by_a_from_b = Eigen::Matrix<double, 5, 3>::Zero();  ///< de / d(x, y, yaw)
};

int residual_rows(const Measurement& measurement);

LinearResidual linearise(const Measurement& measurement, const Pose& a_from_b);

/// S with SᵀS = information: the upper Cholesky factor, or the square root by eigenvalues where the
/// information is singular (negative eigenvalues count as zero).
Eigen::Matrix3d square_root_information(const Eigen::Matrix3d& information);

}  // namespace isthmus
