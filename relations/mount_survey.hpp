#pragma once

#include <Eigen/Core>
#include <string_view>

#include "patches/pose.hpp"

namespace isthmus {

/// How well it is known where a robot carries its laser, as standard deviations: what is left by a survey
/// with a ruler and the eye, a centimetre and about half a degree.
struct MountSurvey {
  double position_sigma_m = 0.01;
  double yaw_sigma_rad = 0.01;
};

/// A map is fitted to what lasers saw; where a laser is not mounted as its robot declared, all of that
/// robot's poses are off by one motion in the robot's own frame. It is the same in each of them, so it
/// neither shows in relations nor does it average out; it vanishes between two poses of one robot only where
/// they are parallel and near. This is what it adds to the covariance of (x, y, yaw) of a_from_b, in a's
/// frame. The names tell whose poses a and b are; an empty one is nobody's (a tag's, a place's), and adds
/// nothing.
Eigen::Matrix3d mount_covariance(const Pose& a_from_b, std::string_view robot_a, std::string_view robot_b,
                                 const MountSurvey& survey = {});

}  // namespace isthmus
