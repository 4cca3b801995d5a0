#pragma once

#include <Eigen/Core>
#include <vector>

#include "patches/pose.hpp"

namespace isthmus {

using Vector5d = Eigen::Matrix<double, 5, 1>;
using Matrix5d = Eigen::Matrix<double, 5, 5>;

/// v = (cos yaw, sin yaw, x, y, 1) of the pose of patch b in patch a.
Vector5d form_variables(const Pose& a_from_b);

/// Any number of correspondences between two patches as one negative log-likelihood ½|R v|², exact for fixed
/// pairing and weights (Howard et al. 2006, eqs. 4-7). R is the upper triangle
/// of a QR of the stacked rows, which keeps its digits near the optimum where the sum of products loses them.
struct QuadraticForm {
  Matrix5d r = Matrix5d::Zero();  ///< upper triangular

  double cost(const Pose& a_from_b) const;                           ///< ½|R v|²
  Vector5d residuals(const Pose& a_from_b) const;                    ///< R v
  Eigen::Matrix<double, 5, 3> jacobian(const Pose& a_from_b) const;  ///< d(R v) / d(x, y, yaw)
  Eigen::Matrix3d information(const Pose& a_from_b) const;           ///< Gauss-Newton's GᵀMG by (x, y, yaw)

  /// The pose of least cost near `start` (directions without information stay at start): the translation is
  /// eliminated exactly and Newton's method finds the yaw.
  struct Minimum {
    Pose a_from_b;
    double cost = 0;
  };
  Minimum minimum(const Pose& start) const;

  /// The pose of least cost of all (directions without information stay at zero).
  Minimum least() const;
};

/// Collects correspondences row by row.
class QuadraticFormBuilder {
 public:
  /// A point p of b on the line through q with unit normal n in a: e = n·(R p + t − q), σ in metres.
  void point_on_line(const Eigen::Vector2d& point_b, const Eigen::Vector2d& line_point_a,
                     const Eigen::Vector2d& line_normal_a, double sigma_m);

  /// A residual `coefficients · v` of unit variance.
  void row(const Vector5d& coefficients);

  int rows() const { return static_cast<int>(rows_.size()); }
  QuadraticForm build() const;

 private:
  std::vector<Vector5d> rows_;
};

}  // namespace isthmus
