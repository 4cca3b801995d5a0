#pragma once

#include <array>
#include <tuple>

#include "patches/pose.hpp"
#include "server/engine/input/options/robot_options.hpp"

namespace isthmus {

/// How far one robot's odometry can be trusted: a fixed shape (noise grows with the way driven and turned)
/// and two scales, of translation and of rotation, learned on line from how far matching disagrees with it.
class OdometryNoise {
 public:
  /// Before anything is learned.
  OdometryNoise() : OdometryNoise(OdometryNoiseOptions{}) {}
  explicit OdometryNoise(const OdometryNoiseOptions& options);

  /// Covariance of the odometry's (x, y, yaw) over one step, in the frame at the step's beginning.
  Eigen::Matrix3d covariance(const Pose& step, const OdometryNoiseOptions& options) const;

  /// One matched step against odometry's account of it. `direction_trust` says in which directions of the
  /// step's own frame matching knows better (1) and in which it merely repeats odometry or guesses (0):
  /// translation is learned only from ways along which matching knows, and along the way only, since wheels
  /// hardly slip sideways. Disagreements beyond `outlier_sigmas` count as so many.
  void learn(const Pose& odometry_step, const Pose& matched_step, const Eigen::Matrix2d& direction_trust,
             const OdometryNoiseOptions& options, const OdometryLearningOptions& learning);

  /// Errors of successive steps have a common part (a wheel's diameter, a late stamp), so a path of many
  /// steps errs more than their sum says: a third scale, learned from patch to patch where `well_seen`.
  /// Returns the covariance to believe for this path, after learning from it; where its way or its turn is
  /// off by more than it may be, even more of that.
  Eigen::Matrix3d path_covariance(const Pose& odometry_path, const Eigen::Matrix3d& summed_covariance,
                                  const Pose& matched_path, bool well_seen,
                                  const OdometryNoiseOptions& options);

  double translation_scale() const { return scale_[0]; }
  double rotation_scale() const { return scale_[1]; }

  auto members() { return std::tie(scale_, path_variance_scale_); }

 private:
  std::array<double, 2> scale_;  // of standard deviations
  double path_variance_scale_;
};

}  // namespace isthmus
