#include "server/engine/localise/localise.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "scanmatch/correlative.hpp"

namespace isthmus {
namespace {

constexpr double most_speed_m_per_s = 5;
constexpr double most_turn_rad_per_s = 3.5;

Eigen::Matrix3d symmetric(const Eigen::Matrix3d& m) { return 0.5 * (m + m.transpose()); }

Eigen::Matrix3d spread_after(const Eigen::Matrix3d& before, const ComposeJacobians& j,
                             const Eigen::Matrix3d& step) {
  return symmetric(j.by_left * before * j.by_left.transpose() + j.by_right * step * j.by_right.transpose());
}

// A match that ends far from where the robot was expected is doubted: squared distance in sigmas, where
// sigma is never smaller than what matching itself errs by.
double surprise(const Pose& pose, const Expectation& expectation) {
  Eigen::Vector3d innovation = to_vector(pose) - to_vector(expectation.local_from_robot);
  innovation.z() = wrap_angle(innovation.z());
  Eigen::Matrix3d covariance = expectation.spread;
  covariance.diagonal() += Eigen::Vector3d(4e-4, 4e-4, 1e-4);
  return innovation.dot(covariance.inverse() * innovation);
}

// Odometry that is back at its origin: the robot was switched off and on, perhaps elsewhere.
bool begins_again(const Pose& odom_from_robot) {
  return std::hypot(odom_from_robot.x, odom_from_robot.y) < 0.05 && std::abs(odom_from_robot.yaw) < 0.05;
}

SearchWindow window_of(const Expectation& expectation) {
  const auto half = [](double variance, double least, double most) {
    return std::clamp(3 * std::sqrt(variance), least, most);
  };
  return {expectation.local_from_robot, half(expectation.covariance(0, 0), 0.4, 1.5),
          half(expectation.covariance(1, 1), 0.4, 1.5), half(expectation.covariance(2, 2), 0.3, 1.2)};
}

}  // namespace

void OdometryPath::append(const Pose& step, const Eigen::Matrix3d& step_covariance) {
  covariance = spread_after(covariance, compose_jacobians(start_from_end, step), step_covariance);
  start_from_end = start_from_end * step;
}

Expectation expect(const Robot& robot, const Pose& odom_from_robot, std::int64_t utime) {
  const Localisation& place = *robot.place;
  Expectation expectation;
  expectation.step = expectation.claimed_step = ominus(odom_from_robot, place.odom_from_robot);
  const double seconds = std::max(0.1, static_cast<double>(utime - place.utime) * 1e-6);
  const double way_m = std::hypot(expectation.step.x, expectation.step.y);
  expectation.plausible = way_m <= 0.3 + most_speed_m_per_s * seconds &&
                          std::abs(expectation.step.yaw) <= 0.5 + most_turn_rad_per_s * seconds &&
                          !(way_m > 0.5 && begins_again(odom_from_robot));
  Eigen::Matrix3d noise = robot.noise.covariance(expectation.step);
  if (!expectation.plausible) {
    expectation.step = Pose{};  // what it says is no motion of a robot; where it is, only matching can tell
    noise = Eigen::Vector3d(0.25, 0.25, 0.1).asDiagonal();
  }
  const Pose& r = place.pose.patch_from_object;
  const ComposeJacobians jacobians = compose_jacobians(r, expectation.step);
  expectation.local_from_robot = r * expectation.step;
  expectation.covariance = spread_after(place.covariance, jacobians, noise);
  expectation.spread = spread_after(place.spread, jacobians, noise);
  return expectation;
}

Placement place(const Robot& robot, const Expectation& expectation, const LocalMap& local_map,
                std::span<const ScanPoint> points, const EngineOptions& options) {
  Placement placement;
  placement.local_from_robot = expectation.local_from_robot;
  placement.covariance = expectation.covariance;
  placement.spread = expectation.spread;
  if (static_cast<int>(points.size()) < options.match.min_pairs) {
    placement.reason = "few_returns";
    return placement;
  }
  if (local_map.patches.empty()) {
    placement.reason = "no_overlap";
    return placement;
  }

  MatchOptions match_options = options.match;
  match_options.sigma_m /= std::sqrt(options.match_trust);
  const Eigen::Matrix3d information = expectation.spread.inverse();
  // Far from where it was expected, or where odometry cannot be believed, a match needs more to be.
  const bool doubtful = !expectation.plausible || robot.place->suspect;
  const auto fits = [&](const Match& match) {
    const bool surprising = surprise(match.local_from_robot, expectation) > 25;
    const double least = doubtful     ? options.found_score
                         : surprising ? options.restart_score
                                      : options.match_score;
    return match.ok && match.quality.score >= least;
  };

  Match best = match_scan(local_map, points, {expectation.local_from_robot, information}, match_options);
  // Other beginnings hold the prediction loosely, and must fit better by so much to be preferred.
  const auto try_from = [&](const Pose& start, double better_by) {
    const Match match = match_scan(local_map, points, {start, 0.04 * information}, match_options);
    if (fits(match) && (!fits(best) || match.quality.score > best.quality.score + better_by)) best = match;
  };
  const Pose& r = robot.place->pose.patch_from_object;
  if (!fits(best) || surprise(best.local_from_robot, expectation) > 16) {
    try_from(expectation.local_from_robot, 0.02);
    try_from(r * robot.place->last_step, 0.05);
    try_from(r, 0.05);
  }
  // Odometry that stood still and then jumps may well be right about where it jumps to: where the laser
  // cannot tell, as in a corridor, it is believed.
  if (!expectation.plausible) try_from(r * expectation.claimed_step, -0.02);
  if (!fits(best)) {
    const CorrelativeResult found = search_window(local_map, points, window_of(expectation));
    if (found.score > 0) try_from(found.local_from_robot, 0.05);
  }
  placement.match = std::move(best);
  if (!fits(placement.match)) {
    placement.reason = placement.match.ok ? "low_score" : "few_pairs";
    return placement;
  }
  placement.matched = true;
  placement.local_from_robot = placement.match.local_from_robot;
  // The same beams, at the calibrated noise of relations, for what is published.
  const double calibration =
      std::pow(match_options.sigma_m / relation_sigma_m(placement.match.quality, options.relations), 2);
  placement.spread =
      symmetric((information + options.match_trust * placement.match.beam_information).inverse());
  placement.covariance = symmetric(
      (expectation.covariance.inverse() + calibration * placement.match.beam_information).inverse());
  return placement;
}

}  // namespace isthmus
