#include "patches/pose.hpp"

#include <cmath>
#include <numbers>

namespace isthmus {

double wrap_angle(double angle_rad) {
  constexpr double pi = std::numbers::pi;
  if (angle_rad > -pi && angle_rad <= pi) return angle_rad;
  const double wrapped = std::remainder(angle_rad, 2 * pi);  // in [-pi, pi]
  return wrapped <= -pi ? pi : wrapped;
}

Eigen::Vector2d rotate(double yaw_rad, const Eigen::Vector2d& vector) {
  const double c = std::cos(yaw_rad);
  const double s = std::sin(yaw_rad);
  return {c * vector.x() - s * vector.y(), s * vector.x() + c * vector.y()};
}

Eigen::Vector2d operator*(const Pose& a_from_b, const Eigen::Vector2d& point_b) {
  return rotate(a_from_b.yaw, point_b) + position(a_from_b);
}

Pose operator*(const Pose& a_from_b, const Pose& b_from_c) {
  const Eigen::Vector2d t = a_from_b * position(b_from_c);
  return {t.x(), t.y(), wrap_angle(a_from_b.yaw + b_from_c.yaw)};
}

Pose inverse(const Pose& a_from_b) {
  const Eigen::Vector2d t = rotate(-a_from_b.yaw, {-a_from_b.x, -a_from_b.y});
  return {t.x(), t.y(), wrap_angle(-a_from_b.yaw)};
}

Pose ominus(const Pose& q, const Pose& pi) {
  const Eigen::Vector2d t = rotate(-pi.yaw, {q.x - pi.x, q.y - pi.y});
  return {t.x(), t.y(), wrap_angle(q.yaw - pi.yaw)};
}

Eigen::Vector2d position(const Pose& a_from_b) { return {a_from_b.x, a_from_b.y}; }

Eigen::Vector3d wrapped_difference(const Pose& a, const Pose& b) {
  return {a.x - b.x, a.y - b.y, wrap_angle(a.yaw - b.yaw)};
}

Eigen::Matrix<double, 2, 3> point_jacobian(const Pose& a_from_b, const Eigen::Vector2d& point_b) {
  const Eigen::Vector2d arm = rotate(a_from_b.yaw, point_b);
  Eigen::Matrix<double, 2, 3> jacobian;
  jacobian << 1, 0, -arm.y(), 0, 1, arm.x();
  return jacobian;
}

ComposeJacobians compose_jacobians(const Pose& a_from_b, const Pose& b_from_c) {
  const double c = std::cos(a_from_b.yaw);
  const double s = std::sin(a_from_b.yaw);
  ComposeJacobians jacobians;
  jacobians.by_left << 1, 0, -s * b_from_c.x - c * b_from_c.y,  //
      0, 1, c * b_from_c.x - s * b_from_c.y,                    //
      0, 0, 1;
  jacobians.by_right << c, -s, 0, s, c, 0, 0, 0, 1;
  return jacobians;
}

OminusJacobians ominus_jacobians(const Pose& q, const Pose& pi) {
  const double c = std::cos(pi.yaw);
  const double s = std::sin(pi.yaw);
  const double dx = q.x - pi.x;
  const double dy = q.y - pi.y;
  OminusJacobians jacobians;
  jacobians.by_q << c, s, 0, -s, c, 0, 0, 0, 1;
  jacobians.by_pi << -c, -s, -s * dx + c * dy,  //
      s, -c, -c * dx - s * dy,                  //
      0, 0, -1;
  return jacobians;
}

Eigen::Matrix3d inverse_jacobian(const Pose& p) {
  const double c = std::cos(p.yaw);
  const double s = std::sin(p.yaw);
  Eigen::Matrix3d jacobian;
  jacobian << -c, -s, s * p.x - c * p.y,  //
      s, -c, c * p.x + s * p.y,           //
      0, 0, -1;
  return jacobian;
}

Eigen::Vector3d to_vector(const Pose& pose) { return {pose.x, pose.y, pose.yaw}; }

Pose to_pose(const Eigen::Vector3d& vector) { return {vector.x(), vector.y(), wrap_angle(vector.z())}; }

bool is_finite(const Pose& pose) {
  return std::isfinite(pose.x) && std::isfinite(pose.y) && std::isfinite(pose.yaw);
}

}  // namespace isthmus
