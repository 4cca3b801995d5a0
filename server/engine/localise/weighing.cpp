#include "server/engine/localise/weighing.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
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

// Log-odds against an error of odometry of this surprise (χ²) and for none: its errors are normal but for the
// few that slipping wheels make. Those have the tails of Cauchy's distribution in three dimensions (as
// Student's t of one degree of freedom in Lange, Little and Taylor, 1989, "Robust statistical modeling using
// the t distribution"), and begin where the normal distribution makes them as unlikely as slips are.
double log_odds_against(double surprise, const LocaliseOptions& options) {
  const double slips = 2 * options.slip_log_odds;
  return surprise < slips ? 0.5 * surprise : options.slip_log_odds + 2 * std::log(surprise / slips);
}

/// Neighbouring points of a scan on one surface.
struct Thing {
  std::span<const ScanPoint> points;
  bool may_move = false;  ///< along with the robot: small, and in front of what is seen beside it
};

// Whether two neighbours are on one surface: farther apart, it would lie too flat to the beams (Borges and
// Aldon, 2004, "Line extraction in 2D range images for mobile robotics", eq. 5).
bool on_one_surface(const ScanPoint& one, const ScanPoint& next, const LocaliseOptions& options) {
  const double nearer_m = std::min(one.position.norm(), next.position.norm());
  const double cosine = one.position.stableNormalized().dot(next.position.stableNormalized());
  const double turn = std::min(std::acos(std::clamp(cosine, -1.0, 1.0)), 0.5 * options.flattest_rad);
  return (next.position - one.position).norm() <
         nearer_m * std::sin(turn) / std::sin(options.flattest_rad - turn) + options.thing_gap_m;
}

// Where fewer points than so many are of what stands, nothing is known to move against it.
std::vector<Thing> things_in(std::span<const ScanPoint> points, int min_standing,
                             const LocaliseOptions& options) {
  std::vector<Thing> things;
  std::size_t standing = 0;
  const auto is_in_front = [&](std::size_t edge, std::size_t beside) {
    return points[beside].position.norm() > points[edge].position.norm();
  };
  std::size_t first = 0;
  for (std::size_t end = 1; end <= points.size(); ++end) {
    if (end < points.size() && on_one_surface(points[end - 1], points[end], options)) continue;
    const bool small = (points[end - 1].position - points[first].position).norm() < options.moving_thing_m;
    const bool in_front =
        (first == 0 || is_in_front(first, first - 1)) && (end == points.size() || is_in_front(end - 1, end));
    const bool before_something = first > 0 || end < points.size();
    things.push_back({points.subspan(first, end - first), small && in_front && before_something});
    if (!things.back().may_move) standing += end - first;
    first = end;
  }
  if (static_cast<int>(standing) < min_standing)
    for (Thing& thing : things) thing.may_move = false;
  return things;
}

std::vector<ScanPoint> points_of_what_stands(std::span<const Thing> things) {
  std::vector<ScanPoint> standing;
  for (const Thing& thing : things)
    if (!thing.may_move) standing.insert(standing.end(), thing.points.begin(), thing.points.end());
  return standing;
}

/// How much worse a scan fits at one pose than at another. What would be seen on ground that the map has not
/// seen says nothing for or against a pose: there the scan is taken to fit as it does elsewhere. Else the
/// pose would be preferred, in a corridor say, at which more of it lies on known ground.
class FitsWorse {
 public:
  /// Keeps references.
  FitsWorse(const Pose& there, const Pose& than, const LocalMap& local_map, const EngineOptions& options)
      : there_(there), than_(than), local_map_(local_map), options_(options) {
    as_it_is_.max_iterations = 0;
    as_it_is_.max_points = std::numeric_limits<int>::max();
  }

  /// Log-odds against the pose by what all points say together; 0: of too few.
  double log_odds(std::span<const ScanPoint> points) const {
    const Fits fits = fits_of(points);
    const double best = fits.than.value(fits.usual());
    return best > 0 ? sharpness(points) * (1 - fits.there.value(fits.usual()) / best) : 0;
  }
  /// By what those of the things say that may move along, which is no wonder: the beams on one say together
  /// what it says once.
  double log_odds_of_what_may_move(std::span<const Thing> things, std::span<const ScanPoint> points) const {
    const Fits all = fits_of(points);
    const double usual = all.usual();
    const double best = all.than.value(usual);
    double sum = 0;
    if (best <= 0) return sum;
    for (const Thing& thing : things) {
      if (!thing.may_move) continue;
      const Fits fits = fits_of(thing.points);
      const double worse_by = (fits.than.value(usual) - fits.there.value(usual)) / best;
      sum += std::min(sharpness(points) * worse_by, options_.localise.moves_along_log_odds);
    }
    return sum;
  }
  double score_there(std::span<const ScanPoint> points) const {
    return match_scan(local_map_, points, {there_, Eigen::Matrix3d::Zero()}, as_it_is_).quality.score;
  }

 private:
  struct Fit {
    double weights = 0;  ///< of the points, as they lie on the map's lines
    double seen = 0;     ///< points on ground that the map has seen
    double unseen = 0;

    double value(double usual) const { return weights + usual * unseen; }
  };
  struct Fits {
    Fit there, than;

    /// Weight of a point on ground that was seen.
    double usual() const { return (there.weights + than.weights) / std::max(1.0, there.seen + than.seen); }
  };

  /// No point says more than one that is independent of all others.
  double sharpness(std::span<const ScanPoint> points) const {
    return std::min(options_.weak_direction.sharpness, static_cast<double>(points.size()));
  }
  bool is_unseen(const Eigen::Vector2d& at) const {
    return std::ranges::none_of(local_map_.patches, [&](const LocalPatch& near) {
      return near.patch->star.depth_m(inverse(near.local_from_patch) * at) > -options_.contradiction.deep_m;
    });
  }
  Fit fit_at(const Pose& pose, std::span<const ScanPoint> points) const {
    const Match match = match_scan(local_map_, points, {pose, Eigen::Matrix3d::Zero()}, as_it_is_);
    std::vector<double> weights(points.size(), 0);
    for (const Pair& pair : match.pairs) weights[static_cast<std::size_t>(pair.point)] += pair.weight;
    Fit fit;
    for (std::size_t i = 0; i < points.size(); ++i) {
      fit.weights += weights[i];
      ++(weights[i] <= 0 && is_unseen(pose * points[i].position) ? fit.unseen : fit.seen);
    }
    return fit;
  }
  Fits fits_of(std::span<const ScanPoint> points) const {
    return {fit_at(there_, points), fit_at(than_, points)};
  }

  const Pose& there_;
  const Pose& than_;
  const LocalMap& local_map_;
  const EngineOptions& options_;
  MatchOptions as_it_is_ = options_.match;
};

std::optional<Match> held_where_expected(const LocalMap& local_map, std::span<const ScanPoint> points,
                                         const Expectation& expectation, const Match& match,
                                         const MatchOptions& match_options, const EngineOptions& options) {
  const LocaliseOptions& its = options.localise;
  const double surprising = surprise(match.local_from_robot, expectation, its);
  if (surprising < its.weighed_surprise.value()) return std::nullopt;
  const Pose& expected = expectation.local_from_robot;
  const Eigen::Vector2d away = (position(match.local_from_robot) - position(expected)).stableNormalized();
  Match held = held_at(expected, away, expectation, local_map, points, match_options,
                       options.weak_direction.held_information);
  // All that it sees may be on ground that nobody has seen: then only odometry tells.
  if (!held.ok) held.local_from_robot = expected;
  const std::vector<Thing> things = things_in(points, match_options.min_pairs, its);
  const std::vector<ScanPoint> standing = points_of_what_stands(things);
  const FitsWorse held_fits_worse(held.local_from_robot, match.local_from_robot, local_map, options);
  const double by_all = held_fits_worse.log_odds(points);
  const double by_what_stands = held_fits_worse.log_odds(standing);
  // Small surprises are weighed by the match itself, unless nothing but what may move speaks for it.
  if (surprising < its.doubted_surprise.value() && by_all - by_what_stands < its.slip_log_odds)
    return std::nullopt;
  const double gained = log_odds_against(surprising, its) -
                        log_odds_against(surprise(held.local_from_robot, expectation, its), its);
  const double by_things = by_what_stands + held_fits_worse.log_odds_of_what_may_move(things, points);
  if (by_things > gained) return std::nullopt;
  // What moved along is no part of what is matched, however many beams it takes.
  held.quality.score = std::max(held.quality.score, held_fits_worse.score_there(standing));
  return held;
}

// Where odometry counts turns wrong, as one whose yaw freezes or is told late, it may count ways right: the
// robot is expected at the heading that scans show; nothing where that is the one expected anyhow.
std::optional<Expectation> turned_as(const Match& match, const Expectation& expectation,
                                     const LocaliseOptions& options) {
  const double off_rad = wrapped_difference(match.local_from_robot, expectation.local_from_robot).z();
  const double known = expectation.tracking_covariance(2, 2) + options.match_variance_rad2;
  if (off_rad * off_rad < options.weighed_surprise.value() * known) return std::nullopt;
  Expectation turned = expectation;
  turned.local_from_robot.yaw = match.local_from_robot.yaw;
  Eigen::Matrix3d& covariance = turned.tracking_covariance;
  covariance.row(2).setZero();
  covariance.col(2).setZero();
  covariance(2, 2) = off_rad * off_rad;
  // Of the way it went meanwhile nobody knows which heading it had.
  covariance.topLeftCorner<2, 2>() +=
      off_rad * off_rad * position(expectation.step).squaredNorm() * Eigen::Matrix2d::Identity();
  return turned;
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
  std::optional<Match> held =
      held_where_expected(local_map, points, expectation, match, match_options, options);
  if (held) return held;
  const std::optional<Expectation> turned = turned_as(match, expectation, options.localise);
  if (!turned) return std::nullopt;
  return held_where_expected(local_map, points, *turned, match, match_options, options);
}

}  // namespace isthmus
