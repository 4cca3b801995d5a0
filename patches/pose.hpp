#pragma once

#include <Eigen/Core>

namespace isthmus {

/// An element of SE(2): metres and radians (yaw counter-clockwise, kept in (-pi, pi]).
///
/// Frames are in names: `map_from_patch` takes a point of the patch into the map. The operators of Howard et
/// al. 2006, III-A are written as products of frames: the paper's r ⊕ π (a pose r in a patch, projected by
/// the patch's pose π) is `map_from_patch * patch_from_robot`, and its inverse q ⊖ π is `ominus(q, pi)`.
struct Pose {
  double x = 0;
  double y = 0;
  double yaw = 0;

  bool operator==(const Pose&) const = default;
};

/// The angle wrapped into (-pi, pi].
double wrap_angle(double angle_rad);

/// Composition: a_from_c = a_from_b * b_from_c.
Pose operator*(const Pose& a_from_b, const Pose& b_from_c);

/// A point of b, in a.
Eigen::Vector2d operator*(const Pose& a_from_b, const Eigen::Vector2d& point_b);

/// b_from_a.
Pose inverse(const Pose& a_from_b);

/// The paper's q ⊖ π: the pose q of the plane seen from the frame π, inverse(pi) * q.
Pose ominus(const Pose& q, const Pose& pi);

/// A direction (no translation) of b, in a.
Eigen::Vector2d rotate(double yaw_rad, const Eigen::Vector2d& vector);

/// Where the origin of b is, in a.
Eigen::Vector2d position(const Pose& a_from_b);

/// a - b by the components (x, y, yaw), in the frame of both; the yaw is wrapped.
Eigen::Vector3d wrapped_difference(const Pose& a, const Pose& b);

/// d(a_from_b * point_b) by the components (x, y, yaw) of a_from_b.
Eigen::Matrix<double, 2, 3> point_jacobian(const Pose& a_from_b, const Eigen::Vector2d& point_b);

/// d(a_from_b * b_from_c) by the components (x, y, yaw) of each factor.
struct ComposeJacobians {
  Eigen::Matrix3d by_left;
  Eigen::Matrix3d by_right;
};
ComposeJacobians compose_jacobians(const Pose& a_from_b, const Pose& b_from_c);

/// d(q ⊖ π) by the components of q and of π.
struct OminusJacobians {
  Eigen::Matrix3d by_q;
  Eigen::Matrix3d by_pi;
};
OminusJacobians ominus_jacobians(const Pose& q, const Pose& pi);

/// d(inverse(p)) by the components of p.
Eigen::Matrix3d inverse_jacobian(const Pose& p);

/// (x, y, yaw) as a vector, and back; the yaw is wrapped on the way back.
Eigen::Vector3d to_vector(const Pose& pose);
Pose to_pose(const Eigen::Vector3d& vector);

bool is_finite(const Pose& pose);

}  // namespace isthmus
