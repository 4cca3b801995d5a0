#include "server/engine/localise/expectation.hpp"

#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

Eigen::Matrix3d covariance_after(const Eigen::Matrix3d& before, const ComposeJacobians& j,
                                 const Eigen::Matrix3d& step) {
  const Eigen::Matrix3d after =
      j.by_left * before * j.by_left.transpose() + j.by_right * step * j.by_right.transpose();
  return 0.5 * (after + after.transpose());
}

// Odometry that is back at its origin: the robot was switched off and on, perhaps elsewhere.
bool begins_again(const Pose& odom_from_robot, const LocaliseOptions& options) {
  return std::hypot(odom_from_robot.x, odom_from_robot.y) < options.origin_m &&
         std::abs(odom_from_robot.yaw) < options.origin_rad;
}

bool is_plausible(const Pose& step, double seconds, const Pose& odom_from_robot,
                  const LocaliseOptions& options) {
  const double way_m = std::hypot(step.x, step.y);
  return way_m <= options.slack_m + options.max_speed_m_per_s * seconds &&
         std::abs(step.yaw) <= options.slack_rad + options.max_turn_rad_per_s * seconds &&
         !(way_m > options.restart_jump_m && begins_again(odom_from_robot, options));
}

// How far two motions over the same time are apart, in those that a robot can make in it.
double apart(const Pose& one, const Pose& other, double seconds, const LocaliseOptions& options) {
  const Eigen::Vector3d off = wrapped_difference(one, other);
  return std::hypot(off.head<2>().norm() / (options.max_speed_m_per_s * seconds),
                    off.z() / (options.max_turn_rad_per_s * seconds));
}

// Odometry that stands still where the robot drove before may have frozen. As far as the robot would have
// gone on, it is not known where it is, and scans may tell: held to rest, they would follow a freeze along a
// corridor. It goes on no faster than it drove before: a scan that was placed too far ahead would let the
// next one be placed farther still. But it may have begun to turn, as fast as any robot does. Until a scan
// tells that it stands, it may go on.
Eigen::Matrix3d covariance_of_freeze(const Localisation& place, double seconds,
                                     const EngineOptions& options) {
  const LocaliseOptions& its = options.localise;
  const Pose& went_on = place.unseen_steps > 0 ? place.last_told : place.last_step;
  if (is_rest(went_on, options.odometry_learning)) return Eigen::Matrix3d::Zero();
  const double way_m = position(went_on).norm(), told_m = position(place.last_told).norm();
  Eigen::Vector3d lost = to_vector(went_on);
  if (way_m > told_m) lost.head<2>() *= told_m / way_m;
  Eigen::Matrix3d covariance = lost * lost.transpose();
  covariance(2, 2) += std::pow(its.max_turn_rad_per_s * seconds, 2) / 3;  // of any turn rate up to that
  return its.freeze_probability * covariance;
}

// Odometry that stood still while the robot moved may have lost that motion, or tell it late and at once. A
// robot's motion goes on much as it was: of the two, that is taken which is more like the last one.
bool is_catching_up(const Localisation& place, const Pose& told, const Pose& caught_up, double seconds,
                    const EngineOptions& options) {
  if (is_rest(place.untold, options.odometry_learning) || is_rest(told, options.odometry_learning))
    return false;
  return apart(caught_up, place.last_step, seconds, options.localise) <
         apart(told, place.last_step, seconds, options.localise);
}

}  // namespace

bool is_rest(const Pose& step, const OdometryLearningOptions& options) {
  return std::hypot(step.x, step.y) < options.rest_m && std::abs(step.yaw) < options.rest_rad;
}

void OdometryPath::append(const Pose& step, const Eigen::Matrix3d& step_covariance) {
  covariance = covariance_after(covariance, compose_jacobians(start_from_end, step), step_covariance);
  start_from_end = start_from_end * step;
}

void OdometryPath::face(double yaw, double variance_rad2) {
  start_from_end.yaw = wrap_angle(yaw);
  covariance.row(2).setZero();
  covariance.col(2).setZero();
  covariance(2, 2) = variance_rad2;
}

void Localisation::append(const Pose& odometry_step, const Eigen::Matrix3d& step_covariance) {
  since_last_patch.append(odometry_step, step_covariance);
  told_since_last_patch.rad = wrap_angle(told_since_last_patch.rad + odometry_step.yaw);
  told_since_last_patch.variance_rad2 += step_covariance(2, 2);
}

Expectation expect(const Robot& robot, const Pose& odom_from_robot, std::int64_t utime,
                   const EngineOptions& options, TurnErrors errors) {
  const Localisation& place = *robot.place;
  Expectation expectation;
  expectation.step = expectation.claimed_step = ominus(odom_from_robot, place.odom_from_robot);
  const LocaliseOptions& its = options.localise;
  const double seconds = expectation.seconds =
      std::max(its.min_period_s, static_cast<double>(utime - place.utime) * 1e-6);
  expectation.step = robot.bias.corrected(expectation.claimed_step);
  if (errors == TurnErrors::going_on)
    expectation.step.yaw = wrap_angle(expectation.step.yaw + robot.turn_error.expected_rad());
  Eigen::Matrix3d noise = robot.noise.covariance(expectation.step, options.odometry_noise);
  const Pose caught_up = inverse(place.untold) * expectation.step;
  expectation.catches_up = is_catching_up(place, expectation.claimed_step, caught_up, seconds, options);
  if (expectation.catches_up) expectation.step = caught_up;
  expectation.plausible = is_plausible(expectation.catches_up ? caught_up : expectation.claimed_step, seconds,
                                       odom_from_robot, its);
  if (!expectation.plausible) {
    expectation.step = Pose{};  // what it says is no motion of a robot; where it is, only matching can tell
    noise = Eigen::Vector3d(its.implausible_variance_m2, its.implausible_variance_m2,
                            its.implausible_variance_rad2)
                .asDiagonal();
  }
  if (expectation.plausible && is_rest(expectation.claimed_step, options.odometry_learning))
    noise += covariance_of_freeze(place, seconds, options);
  // What wheels err by goes on from scan to scan while no match tells: the standard deviations add up.
  noise *= 1 + 2.0 * place.unseen_steps;
  expectation.step_covariance = noise;
  const Pose& r = place.pose.patch_from_object;
  const ComposeJacobians jacobians = compose_jacobians(r, expectation.step);
  expectation.local_from_robot = r * expectation.step;
  expectation.covariance = covariance_after(place.covariance, jacobians, noise);
  expectation.tracking_covariance = covariance_after(place.tracking_covariance, jacobians, noise);
  return expectation;
}

}  // namespace isthmus
