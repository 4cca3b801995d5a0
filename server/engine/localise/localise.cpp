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
    return std::clamp(options.common.window_sigmas * std::sqrt(variance), min, max);
  };
  const Eigen::Matrix3d& covariance = expectation.covariance;
  return {expectation.local_from_robot, half(covariance(0, 0), options.min_window_m, options.max_window_m),
          half(covariance(1, 1), options.min_window_m, options.max_window_m),
          half(covariance(2, 2), options.min_window_rad, options.max_window_rad)};
}

// Where a robot can be by now, at all headings that it can have turned to since its last match, in steps that
// no scan showed. What odometry tells late, scans have shown already: the robot may also be where it was.
SearchWindow window_anew(const Robot& robot, const Expectation& expectation, std::int64_t utime,
                         const LocaliseOptions& options) {
  const Localisation& place = *robot.place;
  const Pose& was = place.pose.patch_from_object;
  const double period_s = std::max(options.min_period_s, static_cast<double>(utime - place.utime) * 1e-6);
  SearchWindow window = window_of(expectation, options);
  const Eigen::Vector2d half_step = 0.5 * (position(was) - position(window.centre));
  window.centre = {window.centre.x + half_step.x(), window.centre.y + half_step.y(),
                   expectation.seen ? window.centre.yaw : was.yaw};
  window.half_x_m += std::abs(half_step.x());
  window.half_y_m += std::abs(half_step.y());
  const int unseen_steps = place.unseen_steps + (expectation.seen ? 0 : 1);
  if (unseen_steps > 0)
    window.half_yaw_rad = std::min(std::numbers::pi, options.max_turn_rad_per_s * period_s * unseen_steps);
  return window;
}

MatchOptions from_scan_to_scan(const EngineOptions& options) {
  MatchOptions match_options = options.match;
  match_options.sigma_m /= std::sqrt(options.localise.match_trust);
  return match_options;
}

// Where odometry does not tell that the robot is there, other walls may look alike. Where it was sought and
// found, what is not as it was when it was mapped may fit worse than usual.
double min_score_in_doubt(const Robot& robot, const Expectation& expectation, const EngineOptions& options) {
  const double least = options.common.sure_score;
  if (expectation.sought && expectation.plausible) return least;
  return std::max(least, robot.usual_misfit.least_score(options.usual_misfit));
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

// A match that was fitted with little of odometry, and odometry: held by it where that outweighs the match,
// and of both where they agree; nothing where odometry is wrong. What agrees says no less for having been
// looked for anew: along a corridor only odometry tells, and forgotten scan by scan it would leave the robot
// anywhere.
std::optional<Match> matched_with_odometry(const LocalMap& near, std::span<const ScanPoint> points,
                                           const Expectation& expectation, const Match& match,
                                           const MatchOptions& match_options, const EngineOptions& options) {
  if (std::optional<Match> held = held_by_odometry(near, points, expectation, match, match_options, options))
    return held;
  if (surprise(match.local_from_robot, expectation, options.localise) >= options.common.surprise.bound(3))
    return std::nullopt;
  // From where the scan fits: where odometry has the robot, turned by degrees, other walls may seem to fit.
  return match_scan(
      near, points,
      {expectation.local_from_robot, expectation.tracking_covariance.inverse(), match.local_from_robot},
      match_options);
}

/// The best of the matches of a scan from one beginning after another.
class WeighedFits {
 public:
  /// Keeps references.
  WeighedFits(const Robot& robot, const Expectation& expectation, const LocalMap& local_map,
              std::span<const ScanPoint> points, const EngineOptions& options)
      : place_(*robot.place),
        expectation_(expectation),
        local_map_(local_map),
        points_(points),
        options_(options),
        its_(options.localise),
        match_options_(from_scan_to_scan(options)),
        information_(expectation.tracking_covariance.inverse()),
        // How far it is from where odometry has the robot is weighed at the end.
        doubtful_(!expectation.is_known() || place_.suspect),
        min_score_(doubtful_ ? min_score_in_doubt(robot, expectation, options) : its_.min_score) {}

  /// From where odometry puts the robot, and from elsewhere where that does not fit, or surprises.
  void try_all() {
    best_ = match_scan(local_map_, points_, {expectation_.local_from_robot, information_}, match_options_);
    const Pose& was = place_.pose.patch_from_object;
    if (!is_good() || surprise(best_.local_from_robot, expectation_, its_) > its_.common.surprise.bound(3)) {
      try_from(expectation_.local_from_robot, its_.loose_gain);
      try_from(was * place_.last_step, its_.other_start_gain);
      try_from(was, its_.other_start_gain);
    } else {
      if (could_fit_better()) try_slipped();
      if (could_fit_better() || is_surprising()) try_going_on();
      if (could_fit_better() && is_rest(expectation_.claimed_step, options_.odometry_learning)) try_set_off();
    }
    // Odometry that stood still and then jumps may well be right about where it jumps to: where the laser
    // cannot tell, as in a corridor, it is believed.
    if (!expectation_.is_known()) try_from(was * expectation_.claimed_step, -its_.loose_gain);
    if (!is_good()) {
      const CorrelativeResult found =
          search_window(local_map_, points_, window_of(expectation_, its_), options_.correlative);
      if (found.score > 0) try_from(found.local_from_robot, its_.other_start_gain);
    }
    if (is_good() && !doubtful_) weigh();
  }

  bool is_good() const { return fits(best_); }
  const Match& match() const { return best_; }

 private:
  // Where odometry cannot be believed, a match needs more to be.
  bool fits(const Match& match) const { return match.ok && match.quality.score >= min_score_; }

  bool is_surprising() const {
    return surprise(best_.local_from_robot, expectation_, its_) > its_.weighed_surprise.bound(3);
  }

  // Whether a slip of the wheels might let the scan fit so much better that it would be believed.
  bool could_fit_better() const {
    return options_.weak_direction.sharpness * (1 - best_.quality.score) > its_.slip_log_odds;
  }

  // Other beginnings hold the prediction loosely, and must fit better by so much to be preferred.
  void try_from(const Pose& start, double better_by) {
    try_from(start, better_by, [](const Pose&) { return true; });
  }
  template <class MayBe>
  void try_from(const Pose& start, double better_by, const MayBe& may_be) {
    const Match match =
        match_scan(local_map_, points_, {start, its_.loose_share * information_}, match_options_);
    if (!fits(match) || (is_good() && match.quality.score <= best_.quality.score + better_by)) return;
    if (!may_be(match.local_from_robot)) return;
    best_ = match;
    held_loosely_ = true;
  }

  // Wheels that slip, or tell motion late, are wrong by no more than they told, or the robot went before.
  void try_slipped() {
    const Pose held = best_.local_from_robot;
    try_from(expectation_.local_from_robot, its_.loose_gain,
             [&](const Pose& found) { return may_have_slipped(found, held); });
  }

  // What they tell too much at once, as they told too little before, may lead to other walls than those where
  // the robot is as it goes on as it did.
  void try_going_on() {
    const Pose held = best_.local_from_robot;
    try_from(place_.pose.patch_from_object * place_.last_step, its_.other_start_gain,
             [&](const Pose& found) { return may_have_slipped(found, held); });
  }

  bool may_have_slipped(const Pose& found, const Pose& held) const {
    const double most_m = way_m(expectation_.claimed_step) + way_m(place_.last_step) +
                          its_.common.window_sigmas * std::sqrt(its_.match_variance_m2);
    return way_m(ominus(found, held)) <= most_m;
  }

  // Odometry that stands still may have frozen as the robot set off. Then it is where going on as it did
  // would bring it, but for what it gained in speed; farther, in a corridor say, are only places that look
  // alike.
  void try_set_off() {
    const double reach_m = its_.max_acceleration_m_per_s2 * std::pow(expectation_.seconds, 2);
    const Pose going_on = place_.pose.patch_from_object * place_.last_step;
    SearchWindow window = window_of(expectation_, its_);
    window.centre.x = going_on.x;
    window.centre.y = going_on.y;
    window.half_x_m = window.half_y_m = reach_m;
    const CorrelativeResult found = search_window(local_map_, points_, window, options_.correlative);
    if (found.score <= 0) return;
    try_from(found.local_from_robot, its_.other_start_gain,
             [&](const Pose& at) { return way_m(ominus(at, going_on)) <= std::numbers::sqrt2 * reach_m; });
  }

  static double way_m(const Pose& step) { return std::hypot(step.x, step.y); }

  void weigh() {
    std::optional<Match> held =
        held_by_odometry(local_map_, points_, expectation_, best_, match_options_, options_);
    if (held) {
      best_ = *std::move(held);
    } else if (held_loosely_) {
      weigh_with_odometry();
    }
  }

  // A match that was held loosely has not been weighed against odometry yet: where wheels need not have
  // slipped for it, what it says little of is left to them.
  void weigh_with_odometry() {
    if (surprise(best_.local_from_robot, expectation_, its_) >= its_.common.surprise.bound(3)) return;
    const Match both =
        match_scan(local_map_, points_, {expectation_.local_from_robot, information_, best_.local_from_robot},
                   match_options_);
    if (fits(both)) best_ = both;
  }

  const Localisation& place_;
  const Expectation& expectation_;
  const LocalMap& local_map_;
  std::span<const ScanPoint> points_;
  const EngineOptions& options_;
  const LocaliseOptions& its_;
  MatchOptions match_options_;
  Eigen::Matrix3d information_;
  bool doubtful_;
  double min_score_;
  Match best_;
  bool held_loosely_ = false;  ///< whether the best was
};

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

  WeighedFits fit(robot, expectation, local_map, points, options);
  fit.try_all();
  if (fit.is_good()) return placement_of(fit.match(), expectation, 1, options);
  placement.reason = fit.match().ok ? Unmatched::low_score : Unmatched::few_pairs;
  placement.match = fit.match();
  return placement;
}

bool is_doubtful(const Placement& placement, const LocaliseOptions& options) {
  return !placement.matched || placement.match.quality.score < options.common.doubtful_score;
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
  // What the search, in its coarse cells, takes for as good need not be: a good match tells.
  const bool ambiguous = found.second_score >= options.ambiguity.share * found.score;
  if (ambiguous && (match.quality.score < its.common.sure_score ||
                    rivals(match, match_from(found.second_local_from_robot), options)))
    return std::nullopt;
  const bool believed = expectation.is_known() && !robot.place->suspect;
  double share = its.loose_share;
  double min_score = its.common.doubtful_score;
  if (!believed) {
    min_score = min_score_in_doubt(robot, expectation, options);
  } else if (std::optional<Match> both =
                 matched_with_odometry(near, points, expectation, match, match_options, options)) {
    match = *std::move(both);
    share = 1;
  } else {
    // What was weighed against odometry, and outweighs it, need not fit as well, unless a scan says the same.
    if (!expectation.seen) min_score = its.min_score;
  }
  if (!match.ok || match.quality.score < min_score) return std::nullopt;
  return placement_of(std::move(match), expectation, share, options);
}

}  // namespace isthmus
