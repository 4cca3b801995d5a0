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

SearchWindow window_of(const Expectation& expectation, const LocaliseOptions& options) {
  const auto half = [&](double variance, double min, double max) {
    return std::clamp(options.window_sigmas * std::sqrt(variance), min, max);
  };
  const Eigen::Matrix3d& covariance = expectation.covariance;
  return {expectation.local_from_robot, half(covariance(0, 0), options.min_window_m, options.max_window_m),
          half(covariance(1, 1), options.min_window_m, options.max_window_m),
          half(covariance(2, 2), options.min_window_rad, options.max_window_rad)};
}

// Where a robot can be by now, at all headings that it can have turned to since its last match. What odometry
// tells late, scans have shown already: the robot may also be where it was.
SearchWindow window_anew(const Robot& robot, const Expectation& expectation, std::int64_t utime,
                         const LocaliseOptions& options) {
  const Localisation& place = *robot.place;
  const Pose& was = place.pose.patch_from_object;
  const double period_s = std::max(options.min_period_s, static_cast<double>(utime - place.utime) * 1e-6);
  SearchWindow window = window_of(expectation, options);
  const Eigen::Vector2d half_step = 0.5 * (position(was) - position(window.centre));
  window.centre = {window.centre.x + half_step.x(), window.centre.y + half_step.y(), was.yaw};
  window.half_x_m += std::abs(half_step.x());
  window.half_y_m += std::abs(half_step.y());
  window.half_yaw_rad = std::min(
      std::numbers::pi, options.slack_rad + options.max_turn_rad_per_s * period_s * (place.lost_scans + 1));
  return window;
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
  // Where odometry cannot be believed, a match needs more to be. How far it is from where odometry has the
  // robot is weighed below.
  const bool doubtful = !expectation.plausible || robot.place->suspect;
  const double min_score = doubtful ? its.min_score_implausible : its.min_score;
  const auto fits = [&](const Match& match) { return match.ok && match.quality.score >= min_score; };

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
  return !placement.matched || placement.match.quality.score < options.doubtful_score;
}

bool rivals(const Match& match, const Match& other, const EngineOptions& options) {
  const Pose apart = ominus(other.local_from_robot, match.local_from_robot);
  return other.ok && other.quality.score > match.quality.score - options.localise.other_start_gain &&
         (std::hypot(apart.x, apart.y) > options.correlative.apart_m ||
          std::abs(apart.yaw) > options.correlative.apart_rad);
}

std::optional<Placement> localise_anew(const Robot& robot, const Expectation& expectation,
                                       const LocalMap& near, std::span<const ScanPoint> points,
                                       std::int64_t utime, const EngineOptions& options) {
  if (static_cast<int>(points.size()) < options.match.min_pairs || near.patches.empty()) return std::nullopt;
  const LocaliseOptions& its = options.localise;
  const MatchOptions match_options = from_scan_to_scan(options);
  const CorrelativeResult found =
      search_window(near, points, window_anew(robot, expectation, utime, its), options.correlative);
  if (found.score <= 0 || found.exhausted) return std::nullopt;
  const Eigen::Matrix3d loose = its.loose_share * expectation.tracking_covariance.inverse();
  const auto match_from = [&](const Pose& start) {
    return match_scan(near, points, {start, loose}, match_options);
  };
  Match match = match_from(found.local_from_robot);
  if (!match.ok) return std::nullopt;
  // What the search, in its coarse cells, takes for as good need not be.
  if (found.second_score >= options.ambiguity.share * found.score &&
      rivals(match, match_from(found.second_local_from_robot), options))
    return std::nullopt;
  if (expectation.plausible && !robot.place->suspect)
    if (std::optional<Match> held =
            held_by_odometry(near, points, expectation, match, match_options, options))
      match = *std::move(held);
  if (!match.ok || match.quality.score < its.doubtful_score) return std::nullopt;
  return placement_of(std::move(match), expectation, its.loose_share, options);
}

}  // namespace isthmus
