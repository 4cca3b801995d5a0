#include "server/features/feature_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "patches/segment.hpp"
#include "server/features/state/growth.hpp"

namespace isthmus {
namespace {

/// The probability of the gate within which an observation that stays unpaired is not taken for a new
/// feature, and in which a scan is paired as a whole that the usual gates leave out.
constexpr double wide_probability = 0.9999;

/// Of a segment's length: where it is looked at.
constexpr std::array<double, 5> sampled_shares = {0.1, 0.3, 0.5, 0.7, 0.9};

/// Points by which one sees whether a feature is still there.
std::vector<Eigen::Vector2d> samples(const Feature& feature) {
  if (feature.kind != FeatureKind::segment) return {feature.a};
  std::vector<Eigen::Vector2d> points;
  for (const double share : sampled_shares) points.push_back(feature.a + share * (feature.b - feature.a));
  return points;
}

bool all_of_it_is_free(const Feature& feature, const std::function<bool(const Eigen::Vector2d&)>& is_free) {
  const auto points = samples(feature);
  return std::all_of(points.begin(), points.end(), is_free);
}

double distance_m(const Feature& feature, const Eigen::Vector2d& point) {
  if (point_count(feature.kind) == 1 || feature.kind == FeatureKind::corner)
    return (point - feature.a).norm();
  return distance_to_segment_m(point, feature.a, feature.b);
}

/// Indices of the features nearest to a robot.
std::vector<std::size_t> nearest(const FeatureState& state, const RobotInState& robot, std::size_t count) {
  std::vector<std::pair<double, std::size_t>> by_distance;
  for (std::size_t i = 0; i < state.features.size(); ++i)
    by_distance.emplace_back(distance_m(state.features[i].feature, position(robot.map_from_robot)), i);
  const auto end = by_distance.begin() + static_cast<std::ptrdiff_t>(std::min(count, by_distance.size()));
  std::partial_sort(by_distance.begin(), end, by_distance.end());
  std::vector<std::size_t> indices;
  for (auto one = by_distance.begin(); one != end; ++one) indices.push_back(one->second);
  return indices;
}

std::vector<Candidate> those(const std::vector<Candidate>& all, const std::vector<std::size_t>& chosen) {
  std::vector<Candidate> result;
  for (const std::size_t i : chosen) result.push_back(all[i]);
  return result;
}

/// Whether pairs agree with one another where a robot's pose could not be bent to fit them: by as many
/// numbers more as a pose has.
bool tells_more_than_a_pose(const std::vector<Candidate>& pairs) {
  constexpr Eigen::Index of_pose = 3;
  Eigen::Index told = 0;
  for (const Candidate& pair : pairs) told += pair.measurement.residual.size();
  return told >= 2 * of_pose;
}

}  // namespace

FeatureFilter::FeatureFilter(const FilterOptions& options)
    : options_(options), gates_(options.association.probability), wide_gates_(wide_probability, 8) {
  state_.form = options.form;
}

int FeatureFilter::add_robot(const Pose& map_from_robot, const Eigen::Matrix3d& covariance) {
  return isthmus::add_robot(state_, map_from_robot, covariance);
}

void FeatureFilter::gather() {
  if (!aside_) return;
  take_back(state_, *aside_);
  aside_.reset();
}

std::size_t FeatureFilter::feature_count() const {
  return state_.features.size() + (aside_ ? aside_->features.size() : 0);
}

void FeatureFilter::replace(FeatureState whole) {
  aside_.reset();
  used_.clear();
  state_ = std::move(whole);
}

/// Whether a feature that is not at hand may be one of those seen. That its covariance has shrunk meanwhile
/// is left out, so no candidate is missed.
bool FeatureFilter::may_see_aside(int robot, std::span<const ObservedFeature> seen) const {
  const Pose& pose = state_.robots[static_cast<std::size_t>(robot)].map_from_robot;
  const std::vector<FeatureInState> now = estimates(*aside_, state_);
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (!is_like_any(now[i].feature, pose, seen, options_.association)) continue;
    const FeatureState both = robot_with(*aside_, i, state_, robot, now[i].feature);
    if (!candidates(both, 0, seen, options_.association, wide_gates_).empty()) return true;
  }
  return false;
}

/// Whether twice as much is at hand as when the rest was set aside: on new ground nothing of it is seen
/// again.
bool FeatureFilter::has_grown() const { return aside_ && state_.covariance.rows() > 3 * state_.told.size(); }

void FeatureFilter::set_aside_what_is_far(int robot, std::span<const ObservedFeature> seen) {
  if (has_grown()) {
    used_.clear();
    gather();
  }
  if (aside_ && may_see_aside(robot, seen)) gather();
  if (aside_ || state_.features.size() <= 2 * options_.at_hand) return;
  std::set<std::size_t> kept;
  for (std::size_t i = 0; i < state_.features.size(); ++i)
    if (state_.features[i].feature.kind == FeatureKind::point || used_.contains(state_.features[i].id))
      kept.insert(i);
  for (const Candidate& one : candidates(state_, robot, seen, options_.association, wide_gates_))
    kept.insert(one.index);
  for (const RobotInState& one : state_.robots)
    for (const std::size_t i : nearest(state_, one, options_.at_hand)) kept.insert(i);
  used_.clear();
  if (2 * kept.size() > state_.features.size()) return;
  aside_ = set_aside(state_, std::vector<std::size_t>(kept.begin(), kept.end()));
}

bool FeatureFilter::move(int robot, const Pose& old_from_new, const Eigen::Matrix3d& covariance) {
  if (!is_finite(old_from_new) || !covariance.allFinite()) return false;
  move_robot(state_, robot, old_from_new, covariance);
  return true;
}

std::vector<Candidate> FeatureFilter::choose(int robot, std::span<const ObservedFeature> seen,
                                             std::vector<bool>& near_known) {
  const AssociationOptions& options = options_.association;
  const std::vector<Candidate> wide = candidates(state_, robot, seen, options, wide_gates_);
  for (const Candidate& one : wide) near_known[one.seen] = true;
  std::vector<Candidate> usual = wide;
  std::erase_if(usual, [&](const Candidate& one) {
    return one.squared_distance >= gates_(one.measurement.residual.size());
  });
  if (options.pairing == Pairing::nearest) return those(usual, nearest_pairs(usual));
  std::vector<Candidate> chosen = those(usual, largest_compatible(state_.covariance, usual, options, gates_));
  if (2 * std::ssize(chosen) >= std::count(near_known.begin(), near_known.end(), true)) return chosen;
  // One error of the robot's, as of a turn, that is rare but no more takes all of a scan out of the usual
  // gates at once: as a whole it is still far likelier than that all is new where walls were expected.
  std::vector<Candidate> together =
      those(wide, largest_compatible(state_.covariance, wide, options, wide_gates_));
  return together.size() > 2 * chosen.size() && tells_more_than_a_pose(together) ? together : chosen;
}

bool FeatureFilter::use(int robot, std::span<const Candidate> chosen, std::span<const ObservedFeature> seen) {
  const auto here = [&](const Candidate& one) {
    return state_.robots[static_cast<std::size_t>(robot)].map_from_robot * seen[one.seen].feature;
  };
  std::vector<LinearMeasurement> measurements;
  for (const Candidate& one : chosen) {
    if (!one.line_alone) learn_from(state_, one.index, here(one), options_.association.end_slack_m);
  }
  for (const Candidate& one : chosen) {
    auto measurement = measure_feature(state_, one.index, robot, seen[one.seen], !one.line_alone);
    if (measurement) measurements.push_back(*std::move(measurement));
  }
  if (!correct(state_, measurements)) return false;
  for (const Candidate& one : chosen) {
    ++state_.features[one.index].seen;
    used_.insert(state_.features[one.index].id);
    reach_to(state_, one.index, here(one));
  }
  return true;
}

bool FeatureFilter::is_confirmed(int robot, const Feature& seen) {
  const TentativeOptions& options = options_.tentative;
  if (options.confirm_after <= 1) return true;
  const Feature here = state_.robots[static_cast<std::size_t>(robot)].map_from_robot * seen;
  for (Tentative& entry : tentative_) {
    if (entry.robot != robot || entry.feature.kind != here.kind) continue;
    if (point_count(here.kind) == 2 &&
        along(here).dot(along(entry.feature)) < std::cos(options.angle_slack_rad))
      continue;
    const LocalVector off = local_coordinates(here, entry.feature);
    const double away = here.kind == FeatureKind::segment ? std::abs(off(1)) : off.head<2>().norm();
    if (away > options.position_slack_m || overlap(here, entry.feature, 0) <= 0) continue;
    entry.feature = here;
    entry.age = 0;
    return ++entry.seen >= options.confirm_after;
  }
  if (tentative_.size() >= options.max_entries) tentative_.erase(tentative_.begin());
  tentative_.push_back({here, robot, 1, 0});
  return false;
}

void FeatureFilter::forget(int robot) {
  for (Tentative& entry : tentative_) entry.age += entry.robot == robot ? 1 : 0;
  std::erase_if(tentative_, [&](const Tentative& entry) {
    return entry.age > options_.tentative.forget_after || entry.seen >= options_.tentative.confirm_after;
  });
}

FeatureScanOutcome FeatureFilter::observe(int robot, std::span<const ObservedFeature> seen) {
  FeatureScanOutcome outcome;
  std::vector<ObservedFeature> sound;
  std::vector<std::size_t> place;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (!is_sound(seen[i])) continue;
    sound.push_back(seen[i]);
    place.push_back(i);
  }
  outcome.unsound = seen.size() - sound.size();
  set_aside_what_is_far(robot, sound);
  // The robot's own start is known to itself: what it sees there is what it finds its heading by.
  const auto is_its_own = [&](const FeatureInState& entry) { return entry.robot == robot; };
  const bool is_first_scan =
      std::none_of(state_.features.begin(), state_.features.end(), is_its_own) &&
      (!aside_ || std::none_of(aside_->features.begin(), aside_->features.end(), is_its_own));
  std::vector<bool> known(sound.size(), false), used(sound.size(), false);
  const std::vector<Candidate> chosen = choose(robot, sound, known);
  if (use(robot, chosen, sound)) {
    for (const Candidate& one : chosen) {
      used[one.seen] = true;
      outcome.paired.push_back({place[one.seen], state_.features[one.index].id, one.line_alone});
    }
  }
  for (std::size_t i = 0; i < sound.size(); ++i) {
    if (used[i]) continue;
    if (known[i]) {
      ++outcome.undecided;
    } else if (!is_first_scan && !is_confirmed(robot, sound[i].feature)) {
      ++outcome.tentative;
    } else if (feature_count() >= options_.max_features) {
      ++outcome.too_many;
    } else {
      outcome.added.push_back({place[i], add_feature(state_, robot, sound[i])});
    }
  }
  forget(robot);
  return outcome;
}

std::vector<int> FeatureFilter::observe_known(int robot, std::span<const ObservedFeature> seen,
                                              std::span<const int> ids) {
  std::vector<int> result(seen.size(), -1);
  std::vector<Candidate> chosen;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const std::optional<std::size_t> index = index_of(state_, ids[i]);
    if (!index || !is_sound(seen[i])) continue;
    auto measurement = measure_feature(state_, *index, robot, seen[i]);
    if (!measurement) continue;
    chosen.push_back({i, *index, *std::move(measurement), 0, false});
    result[i] = ids[i];
  }
  if (!use(robot, chosen, seen)) std::fill(result.begin(), result.end(), -1);
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (ids[i] < 0 && is_sound(seen[i]) && feature_count() < options_.max_features)
      result[i] = add_feature(state_, robot, seen[i]);
  return result;
}

bool FeatureFilter::observe_robot(const RelativeSighting& sighting) {
  const std::optional<LinearMeasurement> measurement = measure_robot(state_, sighting);
  return measurement && correct(state_, {&*measurement, 1});
}

std::vector<int> FeatureFilter::contradict(int robot, const FeatureScanOutcome& outcome,
                                           const std::function<bool(const Eigen::Vector2d&)>& is_free) {
  const Pose robot_from_map = inverse(state_.robots[static_cast<std::size_t>(robot)].map_from_robot);
  const SeenThroughOptions& options = options_.contradiction;
  std::vector<int> gone;
  /// Whether `entry`, which is there by now, goes.
  const auto is_contradicted = [&](FeatureInState& entry, const Feature& there) {
    const bool paired =
        std::any_of(outcome.paired.begin(), outcome.paired.end(),
                    [&](const FeatureScanOutcome::Pair& pair) { return pair.id == entry.id; });
    if (paired || !all_of_it_is_free(robot_from_map * there, is_free)) return false;
    ++entry.contradicted;
    if (entry.contradicted < options.drop_after || entry.contradicted < options.share_of_seen * entry.seen)
      return false;
    gone.push_back(entry.id);
    return true;
  };
  for (std::size_t i = state_.features.size(); i-- > 0;)
    if (is_contradicted(state_.features[i], state_.features[i].feature)) remove_feature(state_, i);
  if (!aside_) return gone;
  const std::vector<FeatureInState> now = estimates(*aside_, state_);
  for (std::size_t i = now.size(); i-- > 0;)
    if (is_contradicted(aside_->features[i], now[i].feature)) remove_feature(*aside_, i);
  return gone;
}

}  // namespace isthmus
