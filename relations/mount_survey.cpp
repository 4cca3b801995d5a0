#include "relations/mount_survey.hpp"

#include <Eigen/Geometry>

namespace isthmus {

Eigen::Matrix3d mount_covariance(const Pose& a_from_b, std::string_view robot_a, std::string_view robot_b,
                                 const MountSurvey& survey) {
  const double position = survey.position_sigma_m * survey.position_sigma_m;
  const Eigen::Matrix3d mount =
      Eigen::Vector3d(position, position, survey.yaw_sigma_rad * survey.yaw_sigma_rad).asDiagonal();
  // Of a^-1 a_from_b b by the small motions a and b in the robots' own frames.
  Eigen::Matrix3d by_a = -Eigen::Matrix3d::Identity();
  by_a(0, 2) = a_from_b.y;
  by_a(1, 2) = -a_from_b.x;
  Eigen::Matrix3d by_b = Eigen::Matrix3d::Identity();
  by_b.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(a_from_b.yaw).toRotationMatrix();
  if (robot_a.empty()) by_a.setZero();
  if (robot_b.empty()) by_b.setZero();
  if (robot_a == robot_b) {
    const Eigen::Matrix3d by_both = by_a + by_b;
    return by_both * mount * by_both.transpose();
  }
  return by_a * mount * by_a.transpose() + by_b * mount * by_b.transpose();
}

}  // namespace isthmus
