#pragma once

#include <Eigen/Core>
#include <tuple>

#include "patches/pose.hpp"
#include "server/engine/input/options/robot_options.hpp"

namespace isthmus {

/// What one robot's odometry errs by always, learned on line from matched steps (the calibration of Censi et
/// al. 2013, linear in small errors): wheels of unlike size turn the robot as it drives, a wheelbase that was
/// measured badly counts turns wrong, and a laser that looks a little aside makes it drive aside. Left in,
/// each pulls every match the same way, and long corridors come out curved.
///
/// For a step with way x and turn φ, in the frame at its beginning:
///
///     yaw error     = turn_per_m x + turn_share φ
///     sideways error = aside_share x + aside_per_rad φ
///     forward error  = way_share x + late x'
///
/// where x' is how much farther odometry would have it if the scans were stamped later by a usual delay
/// (ScanDelay, which takes out what turns tell of one). As a robot sets off, late scans have it drive less
/// far than odometry does: as if its way were counted too long, by all that its speed has grown. Along a
/// corridor that shows nothing of how far a robot went that would not be corrected before its end.
class OdometryBias {
 public:
  /// The step as it most probably was.
  Pose corrected(const Pose& odometry_step) const;

  /// One matched step against odometry's account of it, which errs by so much at random, and would have it so
  /// much farther ahead were the scans late by `scan_delay.sigma_s`. `direction_trust` says in which
  /// directions of the step's own frame matching knows better (1) and in which it merely repeats odometry
  /// (0).
  void learn(const Pose& odometry_step, double farther_if_late_m, const Pose& matched_step,
             const Eigen::Matrix3d& noise, const Eigen::Matrix2d& direction_trust,
             const OdometryBiasOptions& options, const OdometryLearningOptions& learning);

  /// What a path may be turned off by (rad²) for what is not known of the bias, which goes on from path to
  /// path: of an error that is the same over so much way as the estimate remembers, and another after that,
  /// the sum over a long way has the variance of so many independent ones. A robot that matches nothing keeps
  /// what its odometry is declared to err by.
  ///
  /// Of its way nothing is said: of all along a corridor nobody knows how far it went but odometry, and the
  /// less that says, the farther do few beams pull that happen to fit.
  double path_yaw_variance(const Pose& path, const OdometryBiasOptions& options) const;

  double turn_per_m() const { return yaw_.value(0); }
  double turn_share() const { return yaw_.value(1); }
  double aside_share() const { return aside_.value(0); }
  double way_share() const { return way_.value(0); }

  auto members() { return std::tie(yaw_, aside_, way_, remembered_m_, remembered_rad_); }

 private:
  /// An error that is linear in two amounts, by recursive least squares that forgets.
  struct Estimate {
    Eigen::Matrix2d information = Eigen::Matrix2d::Zero();  ///< beyond the prior's
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    Eigen::Vector2d value = Eigen::Vector2d::Zero();

    Eigen::Matrix2d covariance(const Eigen::Vector2d& prior_sigmas) const;
    void learn(const Eigen::Vector2d& regressor, double error, double variance, double kept,
               const Eigen::Vector2d& prior_sigmas, double outlier_sigmas);
    auto members() { return std::tie(information, sum, value); }
  };

  Estimate yaw_;
  Estimate aside_;
  Estimate way_;
  double remembered_m_ = 0;  ///< that the estimates hold, of what was driven: the memory's, in the end
  double remembered_rad_ = 0;
};

}  // namespace isthmus
