#include "scanmatch/features/circle_fit.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace isthmus {
namespace {

constexpr int max_iterations = 15;  // of Gauss-Newton: what has not come to rest by then is no circle

struct Normals {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  double chi_squared = 0;
};

Normals normals_at(std::span<const BeamPoint> points, const Circle& circle) {
  Normals normals;
  for (const BeamPoint& point : points) {
    const Eigen::Vector2d offset = point.position - circle.centre;
    const Eigen::Vector2d outward = offset.normalized();
    const double residual = offset.norm() - circle.radius_m;
    const double weight = 1 / outward.dot(point.covariance * outward);
    const Eigen::Vector3d by(-outward.x(), -outward.y(), -1);
    normals.information += weight * by * by.transpose();
    normals.gradient += weight * residual * by;
    normals.chi_squared += weight * residual * residual;
  }
  return normals;
}

/// Half the points' width for a radius, and the centre behind the nearest point.
Circle first_guess(std::span<const BeamPoint> points) {
  Circle circle;
  circle.radius_m = 0.5 * (points.back().position - points.front().position).norm();
  const Eigen::Vector2d middle = points[points.size() / 2].position;
  circle.centre = middle + circle.radius_m * middle.normalized();
  return circle;
}

}  // namespace

std::optional<Circle> fit_circle(std::span<const BeamPoint> points, double max_m) {
  if (points.size() < 4) return std::nullopt;
  Circle circle = first_guess(points);
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const Normals normals = normals_at(points, circle);
    const Eigen::LDLT<Eigen::Matrix3d> factor(normals.information);
    if (!factor.isPositive() || factor.rcond() < 1e-12) return std::nullopt;
    const Eigen::Vector3d step = -factor.solve(normals.gradient);
    circle.centre += step.head<2>();
    circle.radius_m += step.z();
    if (!step.allFinite() || !(circle.radius_m > 0) || circle.radius_m > max_m) return std::nullopt;
    if (step.norm() > 1e-6) continue;
    circle.covariance = factor.solve(Eigen::Matrix3d::Identity());
    circle.chi_squared = normals.chi_squared;
    return circle;
  }
  return std::nullopt;
}

}  // namespace isthmus
