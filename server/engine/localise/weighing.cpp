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

/// Neighbouring points of a scan on one surface, by their numbers.
struct Thing {
  std::size_t first = 0, end = 0;
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
    things.push_back({first, end, small && in_front && before_something});
    if (!things.back().may_move) standing += end - first;
    first = end;
  }
  if (static_cast<int>(standing) < min_standing)
    for (Thing& thing : things) thing.may_move = false;
  return things;
}

std::vector<Thing> those_that(bool may_move, std::span<const Thing> things) {
  std::vector<Thing> some;
  for (const Thing& thing : things)
    if (thing.may_move == may_move) some.push_back(thing);
  return some;
}

// In pieces no wider than a thing that somebody may have moved since the map was made, or may carry.
std::vector<Thing> in_pieces(std::span<const Thing> things, std::span<const ScanPoint> points,
                             const LocaliseOptions& options) {
  std::vector<Thing> pieces;
  for (const Thing& thing : things) {
    std::size_t first = thing.first;
    for (std::size_t end = first + 1; end <= thing.end; ++end) {
      if (end < thing.end && (points[end].position - points[first].position).norm() < options.moving_thing_m)
        continue;
      pieces.push_back({first, end, thing.may_move});
      first = end;
    }
  }
  return pieces;
}

std::vector<ScanPoint> points_of(std::span<const Thing> things, std::span<const ScanPoint> points) {
  std::vector<ScanPoint> all;
  for (const Thing& thing : things)
    all.insert(all.end(), points.begin() + static_cast<std::ptrdiff_t>(thing.first),
               points.begin() + static_cast<std::ptrdiff_t>(thing.end));
  return all;
}

// A scan where it is said to be.
MatchOptions as_it_is(MatchOptions options) {
  options.max_iterations = 0;
  options.max_points = std::numeric_limits<int>::max();
  return options;
}

/// How much worse a scan fits at one pose than at another. What would be seen on ground that the map has not
/// seen says nothing for or against a pose: there the scan is taken to fit as it does elsewhere. Else the
/// pose would be preferred, in a corridor say, at which more of it lies on known ground.
class FitsWorse {
 public:
  /// Keeps references.
  FitsWorse(const Pose& there, const Pose& than, const LocalMap& local_map, std::span<const ScanPoint> points,
            const EngineOptions& options)
      : points_(points),
        local_map_(local_map),
        options_(options),
        there_(fits_at(there)),
        than_(fits_at(than)) {}

  /// Log-odds against the pose by what all points of some things say together; 0: of too few.
  double log_odds(std::span<const Thing> things) const {
    const Base base = base_of(things);
    double sum = 0;
    for (const Thing& thing : things) sum += base.log_odds(gain_of(thing, base.usual));
    return sum;
  }
  /// By what each of some things says if so much at most can be said by one, as it may not be where the map
  /// has it: the beams on it say together what it says once. Where fewer points than `min_others` are of the
  /// others, nothing is known to be elsewhere. `all`: of what is seen there, that they are of.
  double log_odds_of_each(std::span<const Thing> things, std::span<const Thing> all, double at_most,
                          std::size_t min_others) const {
    const Base base = base_of(all);
    double each = 0, together = 0;
    std::size_t others = 0;
    for (const Thing& thing : things) {
      const double says = base.log_odds(gain_of(thing, base.usual));
      together += says;
      each += std::min(says, at_most);
      if (says <= at_most) others += thing.end - thing.first;
    }
    return others < min_others ? together : each;
  }

 private:
  /// Of a point, as it lies on the map's lines.
  struct Fit {
    double weight = 0;
    bool unseen = false;  ///< it lies on ground that the map has not seen

    double value(double usual) const { return unseen ? usual : weight; }
  };
  struct Base {
    double usual = 0;  ///< weight of a point on ground that was seen
    double best = 0;   ///< value of all at the better pose
    double sharpness = 0;

    double log_odds(double gain) const { return best > 0 ? sharpness * gain / best : 0; }
  };

  Base base_of(std::span<const Thing> things) const {
    Base base;
    double weights = 0;
    std::size_t seen = 0, count = 0;
    for (const Thing& thing : things) {
      count += thing.end - thing.first;
      for (std::size_t i = thing.first; i < thing.end; ++i)
        for (const Fit* fit : {&there_[i], &than_[i]}) {
          weights += fit->weight;
          seen += !fit->unseen;
        }
    }
    base.usual = weights / static_cast<double>(std::max<std::size_t>(1, seen));
    for (const Thing& thing : things)
      for (std::size_t i = thing.first; i < thing.end; ++i) base.best += than_[i].value(base.usual);
    // No point says more than one that is independent of all others.
    base.sharpness = std::min(options_.weak_direction.sharpness, static_cast<double>(count));
    return base;
  }
  double gain_of(const Thing& thing, double usual) const {
    double gain = 0;
    for (std::size_t i = thing.first; i < thing.end; ++i)
      gain += than_[i].value(usual) - there_[i].value(usual);
    return gain;
  }
  bool is_unseen(const Eigen::Vector2d& at) const {
    return std::ranges::none_of(local_map_.patches, [&](const LocalPatch& near) {
      return near.patch->star.depth_m(inverse(near.local_from_patch) * at) > -options_.contradiction.deep_m;
    });
  }
  std::vector<Fit> fits_at(const Pose& pose) const {
    const Match match =
        match_scan(local_map_, points_, {pose, Eigen::Matrix3d::Zero()}, as_it_is(options_.match));
    std::vector<Fit> fits(points_.size());
    for (const Pair& pair : match.pairs) fits[static_cast<std::size_t>(pair.point)].weight += pair.weight;
    for (std::size_t i = 0; i < points_.size(); ++i)
      fits[i].unseen = fits[i].weight <= 0 && is_unseen(pose * points_[i].position);
    return fits;
  }

  std::span<const ScanPoint> points_;
  const LocalMap& local_map_;
  const EngineOptions& options_;
  std::vector<Fit> there_, than_;
};

std::optional<Match> held_where_expected(const LocalMap& local_map, std::span<const ScanPoint> points,
                                         const Expectation& expectation, const Match& match,
                                         const MatchOptions& match_options, const EngineOptions& options) {
  const LocaliseOptions& its = options.localise;
  const double surprising = surprise(match.local_from_robot, expectation, its);
  if (surprising < its.weighed_surprise.bound(3)) return std::nullopt;
  const Pose& expected = expectation.local_from_robot;
  const Eigen::Vector2d away = (position(match.local_from_robot) - position(expected)).stableNormalized();
  Match held = held_at(expected, away, expectation, local_map, points, match_options,
                       options.weak_direction.held_information);
  // All that it sees may be on ground that nobody has seen: then only odometry tells.
  if (!held.ok) held.local_from_robot = expected;
  const std::vector<Thing> things = things_in(points, match_options.min_pairs, its);
  const std::vector<Thing> standing = those_that(false, things);
  const FitsWorse held_fits_worse(held.local_from_robot, match.local_from_robot, local_map, points, options);
  const double by_all = held_fits_worse.log_odds(things);
  const double by_what_stands = held_fits_worse.log_odds(standing);
  // Small surprises are weighed by the match itself, unless nothing but what may move speaks for it.
  if (surprising < its.common.surprise.bound(3) && by_all - by_what_stands < its.slip_log_odds)
    return std::nullopt;
  const double gained = log_odds_against(surprising, its) -
                        log_odds_against(surprise(held.local_from_robot, expectation, its), its);
  const double by_things =
      held_fits_worse.log_odds_of_each(in_pieces(standing, points, its), standing, its.changed_log_odds,
                                       static_cast<std::size_t>(match_options.min_pairs)) +
      held_fits_worse.log_odds_of_each(those_that(true, things), things, its.moves_along_log_odds, 0);
  if (by_things > gained) return std::nullopt;
  // What moved along is no part of what is matched, however many beams it takes.
  const Match of_what_stands =
      match_scan(local_map, points_of(standing, points), {held.local_from_robot, Eigen::Matrix3d::Zero()},
                 as_it_is(options.match));
  held.quality.score = std::max(held.quality.score, of_what_stands.quality.score);
  return held;
}

// Where odometry counts turns wrong, as one whose yaw freezes or is told late, it may count ways right: the
// robot is expected at the heading that scans show; nothing where that is the one expected anyhow.
std::optional<Expectation> turned_as(const Match& match, const Expectation& expectation,
                                     const LocaliseOptions& options) {
  const double off_rad = wrapped_difference(match.local_from_robot, expectation.local_from_robot).z();
  const double known = expectation.tracking_covariance(2, 2) + options.match_variance_rad2;
  if (off_rad * off_rad < options.weighed_surprise.bound(3) * known) return std::nullopt;
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
