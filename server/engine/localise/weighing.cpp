#include "server/engine/localise/weighing.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

namespace isthmus {
namespace {

Match held_at(const Pose& expected, const Eigen::Vector2d& away, const Expectation& expectation,
              const LocalMap& local_map, std::span<const ScanPoint> points, const MatchOptions& match_options,
              double held_information) {
  Prediction prediction{expected, expectation.tracking_covariance.inverse()};
  prediction.information.topLeftCorner<2, 2>() += held_information * away * away.transpose();
  Match held = match_scan(local_map, points, prediction, match_options);
  Eigen::Matrix3d across = Eigen::Matrix3d::Identity();
  across.topLeftCorner<2, 2>() -= away * away.transpose();
  const Eigen::Matrix3d information = across * held.beam_information * across;
  held.beam_information = 0.5 * (information + information.transpose());
  held.direction_trust = across.topLeftCorner<2, 2>() * held.direction_trust;
  return held;
}

// Whether points first to end - 1 of a scan, neighbours on one thing, are something that may move along with
// the robot: no larger than that, and in front of what is seen beside them.
bool may_move(std::span<const ScanPoint> points, std::size_t first, std::size_t end,
              const LocaliseOptions& options) {
  const auto is_behind = [&](std::size_t beside, std::size_t edge) {
    return points[beside].position.norm() > points[edge].position.norm() + options.thing_gap_m;
  };
  return (points[end - 1].position - points[first].position).norm() < options.moving_thing_m &&
         (first == 0 || is_behind(first - 1, first)) && (end == points.size() || is_behind(end, end - 1));
}

std::vector<ScanPoint> points_of_what_stands(std::span<const ScanPoint> points,
                                             const LocaliseOptions& options) {
  std::vector<ScanPoint> standing;
  std::size_t first = 0;
  for (std::size_t end = 1; end <= points.size(); ++end) {
    if (end < points.size() && (points[end].position - points[end - 1].position).norm() < options.thing_gap_m)
      continue;
    if (!may_move(points, first, end, options)) {
      const std::span<const ScanPoint> thing = points.subspan(first, end - first);
      standing.insert(standing.end(), thing.begin(), thing.end());
    }
    first = end;
  }
  return standing;
}

// Log-odds against a pose by which a scan fits worse there than where it was matched; nothing where too few
// of the points are seen from there.
std::optional<double> log_odds_against(const Pose& held, const Pose& matched, const LocalMap& local_map,
                                       std::span<const ScanPoint> points, const EngineOptions& options) {
  MatchOptions as_it_is = options.match;
  as_it_is.max_iterations = 0;
  const auto score_at = [&](const Pose& pose) {
    return match_scan(local_map, points, {pose, Eigen::Matrix3d::Zero()}, as_it_is).quality.score;
  };
  const double best = score_at(matched);
  if (best <= 0) return std::nullopt;
  return options.weak_direction.sharpness * std::max(0.0, 1 - score_at(held) / best);
}

}  // namespace

double surprise(const Pose& local_from_robot, const Expectation& expectation,
                const LocaliseOptions& options) {
  const Eigen::Vector3d innovation = wrapped_difference(local_from_robot, expectation.local_from_robot);
  Eigen::Matrix3d covariance = expectation.tracking_covariance;
  covariance.diagonal() +=
      Eigen::Vector3d(options.match_variance_m2, options.match_variance_m2, options.match_variance_rad2);
  return innovation.dot(covariance.inverse() * innovation);
}

std::optional<Match> held_by_odometry(const LocalMap& local_map, std::span<const ScanPoint> points,
                                      const Expectation& expectation, const Match& match,
                                      const MatchOptions& match_options, const EngineOptions& options) {
  const LocaliseOptions& its = options.localise;
  const double surprising = surprise(match.local_from_robot, expectation, its);
  if (surprising < its.weighed_surprise.value()) return std::nullopt;
  const Pose& expected = expectation.local_from_robot;
  const Eigen::Vector2d away = (position(match.local_from_robot) - position(expected)).stableNormalized();
  Match held = held_at(expected, away, expectation, local_map, points, match_options,
                       options.weak_direction.held_information);
  if (!held.ok) return std::nullopt;
  const auto against = [&](std::span<const ScanPoint> seen) {
    return log_odds_against(held.local_from_robot, match.local_from_robot, local_map, seen, options);
  };
  const double by_all = against(points).value_or(0);
  const double by_what_stands = against(points_of_what_stands(points, its)).value_or(by_all);
  // Small surprises are weighed by the match itself, unless nothing but what may move speaks for it.
  if (surprising < its.doubted_surprise.value() && by_all - by_what_stands < its.slip_log_odds)
    return std::nullopt;
  const double gained = 0.5 * (surprising - surprise(held.local_from_robot, expectation, its));
  if (by_what_stands > std::min(gained, its.slip_log_odds)) return std::nullopt;
  return held;
}

}  // namespace isthmus
