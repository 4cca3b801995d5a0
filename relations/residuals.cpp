#include "relations/residuals.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

namespace isthmus {
namespace {

/// Points nearer than this have no direction: the derivative of range and bearing is limited there.
constexpr double min_distance_m = 1e-6;

/// e = R v (5): correspondences of points of b with points and lines of a, in a's frame; Howard et al. 2006,
/// eqs. 4 and 7 summed over the pair. Noise: Gaussian per correspondence, its sigma in the rows of the form.
LinearResidual linearise(const Correspondences& measured, const Pose& a_from_b) {
  return {5, measured.form.residuals(a_from_b), measured.form.jacobian(a_from_b)};
}

/// e = S (x − x̃, y − ỹ, yaw − ỹaw) (3): the pose of b in a less the measured one, in a's frame, the angle
/// wrapped. Noise: Gaussian in those three with information SᵀS.
LinearResidual linearise(const RelativePose& measured, const Pose& a_from_b) {
  const Eigen::Matrix3d s = square_root_information(measured.information);
  LinearResidual residual;
  residual.rows = 3;
  residual.e.head<3>() = s * wrapped_difference(a_from_b, measured.a_from_b);
  residual.by_a_from_b.topRows<3>() = s;
  return residual;
}

/// e = (|T p − q| − r) / σ (1): the distance of b's point p from a's point q, both in a's frame, less the
/// measured range r ("relative range", Howard et al. 2006, III-B). Noise: Gaussian in range, σ in metres.
LinearResidual linearise(const Range& measured, const Pose& a_from_b) {
  const Eigen::Vector2d between = a_from_b * measured.point_b - measured.point_a;
  const double distance = between.norm();
  const Eigen::Vector2d direction =
      distance > min_distance_m ? Eigen::Vector2d(between / distance) : Eigen::Vector2d::UnitX();
  LinearResidual residual;
  residual.rows = 1;
  residual.e(0) = (distance - measured.range_m) / measured.sigma_m;
  residual.by_a_from_b.row(0) =
      direction.transpose() * point_jacobian(a_from_b, measured.point_b) / measured.sigma_m;
  return residual;
}

/// e = wrap(atan2(o_y, o_x) − β) / σ (1): the direction of b's point, seen in the frame of an observer that
/// is fixed in a, less the measured bearing β ("relative bearing", Howard et al. 2006, III-B). Noise:
/// Gaussian in angle, σ in radians.
LinearResidual linearise(const Bearing& measured, const Pose& a_from_b) {
  const double observer_yaw = measured.a_from_observer.yaw;
  const Eigen::Vector2d from_observer = a_from_b * measured.point_b - position(measured.a_from_observer);
  const Eigen::Vector2d seen = rotate(-observer_yaw, from_observer);
  const double squared = std::max(seen.squaredNorm(), min_distance_m * min_distance_m);
  const Eigen::RowVector2d by_point_a = Eigen::RowVector2d(-from_observer.y(), from_observer.x()) / squared;
  LinearResidual residual;
  residual.rows = 1;
  residual.e(0) = wrap_angle(std::atan2(seen.y(), seen.x()) - measured.bearing_rad) / measured.sigma_rad;
  residual.by_a_from_b.row(0) = by_point_a * point_jacobian(a_from_b, measured.point_b) / measured.sigma_rad;
  return residual;
}

}  // namespace

int residual_rows(const Measurement& measurement) {
  if (std::holds_alternative<Correspondences>(measurement)) return 5;
  return std::holds_alternative<RelativePose>(measurement) ? 3 : 1;
}

LinearResidual linearise(const Measurement& measurement, const Pose& a_from_b) {
  return std::visit([&](const auto& measured) { return linearise(measured, a_from_b); }, measurement);
}

Eigen::Matrix3d square_root_information(const Eigen::Matrix3d& information) {
  const Eigen::LLT<Eigen::Matrix3d> cholesky(information);
  if (cholesky.info() == Eigen::Success) return cholesky.matrixU();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(information);
  return eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace isthmus
