#include "server/engine/localise/localise.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "scanmatch/correlative.hpp"
#include "server/engine/localise/weighing.hpp"

namespace isthmus {
namespace {

Eigen::Matrix3d symmetric(const Eigen::Matrix3d& m) { return 0.5 * (m + m.transpose()); }

Eigen::Matrix3d covariance_after(const Eigen::Matrix3d& before, const ComposeJacobians& j,
                                 const Eigen::Matrix3d& step) {
  return symmetric(j.by_left * before * j.by_left.transpose() + j.by_right * step * j.by_right.transpose());
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

SearchWindow window_of(const Expectation& expectation, const LocaliseOptions& options) {
  const auto half = [&](double variance, double min, double max) {
    return std::clamp(options.window_sigmas * std::sqrt(variance), min, max);
  };
  const Eigen::Matrix3d& covariance = expectation.covariance;
  return {expectation.local_from_robot, half(covariance(0, 0), options.min_window_m, options.max_window_m),
          half(covariance(1, 1), options.min_window_m, options.max_window_m),
          half(covariance(2, 2), options.min_window_rad, options.max_window_rad)};
}

MatchOptions from_scan_to_scan(const EngineOptions& options) {
  MatchOptions match_options = options.match;
  match_options.sigma_m /= std::sqrt(options.localise.match_trust);
  return match_options;
}

// A match together with the share of what was expected that it was fitted with. The same beams count at the
// calibrated noise of relations for what is published.
Placement placement_of(Match match, const Expectation& expectation, double share,
                       const EngineOptions& options) {
  const LocaliseOptions& its = options.localise;
  Placement placement;
  placement.matched = true;
  placement.local_from_robot = match.local_from_robot;
  const double sigma_m = from_scan_to_scan(options).sigma_m;
  const double calibration = std::pow(sigma_m / relation_sigma_m(match.quality, options.relations), 2);
  placement.tracking_covariance =
      symmetric((share * expectation.tracking_covariance.inverse() + its.match_trust * match.beam_information)
                    .inverse());
  placement.covariance =
      symmetric((share * expectation.covariance.inverse() + calibration * match.beam_information).inverse());
  placement.match = std::move(match);
  return placement;
}

}  // namespace

void OdometryPath::append(const Pose& step, const Eigen::Matrix3d& step_covariance) {
  covariance = covariance_after(covariance, compose_jacobians(start_from_end, step), step_covariance);
  start_from_end = start_from_end * step;
}

Expectation expect(const Robot& robot, const Pose& odom_from_robot, std::int64_t utime,
                   const EngineOptions& options) {
  const Localisation& place = *robot.place;
  Expectation expectation;
  expectation.step = expectation.claimed_step = ominus(odom_from_robot, place.odom_from_robot);
  const LocaliseOptions& its = options.localise;
  const double seconds = std::max(its.min_period_s, static_cast<double>(utime - place.utime) * 1e-6);
  expectation.plausible = is_plausible(expectation.step, seconds, odom_from_robot, its);
  expectation.step = robot.bias.corrected(expectation.claimed_step);
  Eigen::Matrix3d noise = robot.noise.covariance(expectation.step, options.odometry_noise);
  if (!expectation.plausible) {
    expectation.step = Pose{};  // what it says is no motion of a robot; where it is, only matching can tell
    noise = Eigen::Vector3d(its.implausible_variance_m2, its.implausible_variance_m2,
                            its.implausible_variance_rad2)
                .asDiagonal();
  }
  const Pose& r = place.pose.patch_from_object;
  const ComposeJacobians jacobians = compose_jacobians(r, expectation.step);
  expectation.local_from_robot = r * expectation.step;
  expectation.covariance = covariance_after(place.covariance, jacobians, noise);
  expectation.tracking_covariance = covariance_after(place.tracking_covariance, jacobians, noise);
  return expectation;
}

Placement localise(const Robot& robot, const Expectation& expectation, const LocalMap& local_map,
                   std::span<const ScanPoint> points, const EngineOptions& options) {
  Placement placement;
  placement.local_from_robot = expectation.local_from_robot;
  placement.covariance = expectation.covariance;
  placement.tracking_covariance = expectation.tracking_covariance;
  if (static_cast<int>(points.size()) < options.match.min_pairs) {
    placement.reason = Unmatched::few_returns;
    return placement;
  }
  if (local_map.patches.empty()) {
    placement.reason = Unmatched::no_overlap;
    return placement;
  }

  const LocaliseOptions& its = options.localise;
  const MatchOptions match_options = from_scan_to_scan(options);
  const Eigen::Matrix3d information = expectation.tracking_covariance.inverse();
  // Far from where it was expected, or where odometry cannot be believed, a match needs more to be.
  const bool doubtful = !expectation.plausible || robot.place->suspect;
  const auto fits = [&](const Match& match) {
    const bool surprising = surprise(match.local_from_robot, expectation, its) > its.far_surprise.value();
    const double min_score = doubtful     ? its.min_score_implausible
                             : surprising ? its.min_score_far
                                          : its.min_score;
    return match.ok && match.quality.score >= min_score;
  };

  Match best = match_scan(local_map, points, {expectation.local_from_robot, information}, match_options);
  // Other beginnings hold the prediction loosely, and must fit better by so much to be preferred.
  const auto try_from = [&](const Pose& start, double better_by) {
    const Match match = match_scan(local_map, points, {start, its.loose_share * information}, match_options);
    if (fits(match) && (!fits(best) || match.quality.score > best.quality.score + better_by)) best = match;
  };
  const Pose& r = robot.place->pose.patch_from_object;
  if (!fits(best) || surprise(best.local_from_robot, expectation, its) > its.doubted_surprise.value()) {
    try_from(expectation.local_from_robot, its.loose_gain);
    try_from(r * robot.place->last_step, its.other_start_gain);
    try_from(r, its.other_start_gain);
  }
  // Odometry that stood still and then jumps may well be right about where it jumps to: where the laser
  // cannot tell, as in a corridor, it is believed.
  if (!expectation.plausible) try_from(r * expectation.claimed_step, -its.claimed_start_loss);
  if (!fits(best)) {
    const CorrelativeResult found =
        search_window(local_map, points, window_of(expectation, its), options.correlative);
    if (found.score > 0) try_from(found.local_from_robot, its.other_start_gain);
  }
  if (fits(best) && !doubtful)
    if (std::optional<Match> held =
            held_by_odometry(local_map, points, expectation, best, match_options, options))
      if (fits(*held)) best = *std::move(held);
  if (fits(best)) return placement_of(std::move(best), expectation, 1, options);
  placement.reason = best.ok ? Unmatched::low_score : Unmatched::few_pairs;
  placement.match = std::move(best);
  return placement;
}

bool is_doubtful(const Placement& placement, const LocaliseOptions& options) {
  return !placement.matched || placement.match.quality.score < options.min_score_far;
}

std::optional<Placement> localise_anew(const Robot& robot, const Expectation& expectation,
                                       const LocalMap& near, std::span<const ScanPoint> points,
                                       std::int64_t utime, const EngineOptions& options) {
  if (static_cast<int>(points.size()) < options.match.min_pairs || near.patches.empty()) return std::nullopt;
  const LocaliseOptions& its = options.localise;
  const Localisation& place = *robot.place;
  const double period_s = std::max(its.min_period_s, static_cast<double>(utime - place.utime) * 1e-6);
  SearchWindow window = window_of(expectation, its);
  window.centre.yaw = place.pose.patch_from_object.yaw;
  window.half_yaw_rad =
      std::min(std::numbers::pi, its.slack_rad + its.max_turn_rad_per_s * period_s * (place.lost_scans + 1));
  const CorrelativeResult found = search_window(near, points, window, options.correlative);
  if (found.score <= 0 || found.exhausted || found.second_score >= options.ambiguity.share * found.score)
    return std::nullopt;
  Match match = match_scan(
      near, points, {found.local_from_robot, its.loose_share * expectation.tracking_covariance.inverse()},
      from_scan_to_scan(options));
  if (!match.ok || match.quality.score < its.min_score_far) return std::nullopt;
  return placement_of(std::move(match), expectation, its.loose_share, options);
}

}  // namespace isthmus
