#include "server/features/fusion/twin_search.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "server/features/association/joint_factor.hpp"

namespace isthmus {
namespace {

constexpr double around_m = 5;         // within which features are counted
constexpr double parallel_rad = 0.35;  // walls that count beside one: a building's others are at right angles

/// Of its place, or of a segment's line and middle along it as far as known.
double place_sigma_m(const FeatureState& state, std::size_t index) {
  const LocalMatrix by = project_to_feature(state.features[index].feature).topRows<2>();
  return std::sqrt((by * feature_covariance(state, index) * by.transpose()).trace());
}

bool alike(const Feature& one, const Feature& other, double sigma_m, const FusionOptions& options) {
  if (one.kind != other.kind || (one.kind == FeatureKind::point && !options.points)) return false;
  if (one.kind == FeatureKind::corner)
    return std::abs(one.opening_rad - other.opening_rad) < options.association.opening_tolerance_rad;
  return one.kind != FeatureKind::segment || overlap(one, other, sigma_m) >= options.association.min_overlap;
}

/// A turn that errs by σ bends what it moves sideways: where `bend` is σ² times the arm, −bend/2 on average,
/// and bend bendᵀ / 2 more variance, both nothing once a few ties hold (the modified second-order filter of
/// Athans, Wishner and Bertolini 1968).
void allow_for(const Eigen::Vector2d& bend, TwinCandidate& candidate) {
  const LocalVector by = candidate.tie.by_maps.leftCols<2>() * bend;
  candidate.residual += 0.5 * by;
  candidate.covariance += 0.5 * by * by.transpose();
}

/// Of the arc on which the place of the second map lies, about the robot that measured the range.
Eigen::Vector2d bend_of_arc(const TiedMaps& maps, const Eigen::Matrix3d& put) {
  const Eigen::Vector2d arm = maps.about - maps.seen_from;
  if (!(arm.squaredNorm() > 0)) return Eigen::Vector2d::Zero();
  const Eigen::Vector2d tangent = quarter_turn(arm.normalized());
  return tangent.dot(put.topLeftCorner<2, 2>() * tangent) / arm.squaredNorm() * arm;
}

/// The ways to pair one group: one level for each feature of the second map.
class GroupSearch {
 public:
  GroupSearch(const std::vector<TwinCandidate>& all, const Eigen::MatrixXd& joint, const Gates& gates,
              const FusionOptions& options)
      : all_(all), joint_(joint), gates_(gates), options_(options) {
    Eigen::Index at = 0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (i == 0 || all[i].two != all[i - 1].two) levels_.emplace_back();
      levels_.back().push_back(i);
      starts_.push_back(at);
      at += all[i].residual.size();
    }
    for (const auto& level : levels_) {
      best_with_.emplace_back(level.size() + 1, none);
      chosen_.push_back(level.size());
    }
  }

  struct Found {
    std::vector<std::size_t> pairs;
    std::size_t steps = 0;
  };

  /// None where the search did not come to its end: what it has not looked at may be as likely.
  Found certain() {
    if (!bound_rest()) return {};
    descend(0, 0);
    if (steps_ > options_.association.max_steps) return {{}, steps_};
    std::vector<std::size_t> result;
    for (std::size_t level = 0; level < levels_.size(); ++level) {
      auto& with = best_with_[level];
      const auto best = std::max_element(with.begin(), with.end());
      const auto which = static_cast<std::size_t>(best - with.begin());
      const double likely = *best;
      if (which == levels_[level].size()) continue;
      *best = none;
      if (likely - *std::max_element(with.begin(), with.end()) >= options_.min_log_odds)
        result.push_back(levels_[level][which]);
    }
    return {std::move(result), steps_};
  }

 private:
  static constexpr double none = -std::numeric_limits<double>::infinity();

  /// The most that each level can add: with a residual of zero, and given all that the levels before it may
  /// have chosen, for what is given in addition only narrows a density. False where the errors have no
  /// density.
  bool bound_rest() {
    const Eigen::LLT<Eigen::MatrixXd> factor(joint_);
    if (factor.info() != Eigen::Success) return false;
    const Eigen::MatrixXd root = factor.matrixL();
    most_from_.assign(levels_.size() + 1, 0);
    for (std::size_t level = levels_.size(); level-- > 0;) {
      const Eigen::Index from = starts_[levels_[level].front()];
      double gain = 0;
      for (const std::size_t i : levels_[level]) {
        const Eigen::Index size = all_[i].residual.size(), columns = starts_[i] + size - from;
        const auto below = root.block(starts_[i], from, size, columns);
        const LocalMatrix given = below * below.transpose();
        const double log_det =
            std::log(given.determinant()) - (all_[i].silent_rows == 1 ? std::log(given(0, 0)) : 0);
        gain = std::max(gain, log_odds(i, log_det));
      }
      most_from_[level] = most_from_[level + 1] + gain;
    }
    return true;
  }

  double log_odds(std::size_t i, double minus_two_log_density) const {
    const auto size = static_cast<double>(all_[i].residual.size() - all_[i].silent_rows);
    return -0.5 * (minus_two_log_density + size * std::log(2 * std::numbers::pi)) - all_[i].log_chance;
  }

  bool is_taken(std::size_t one) const {
    for (std::size_t level = 0; level < levels_.size(); ++level)
      if (chosen_[level] < levels_[level].size() && all_[levels_[level][chosen_[level]]].one == one)
        return true;
    return false;
  }

  void descend(std::size_t level, double likely) {
    if (likely + most_from_[level] < best_ - options_.min_log_odds) return;
    if (steps_ > options_.association.max_steps || ++steps_ > options_.association.max_steps) return;
    if (level == levels_.size()) {
      best_ = std::max(best_, likely);
      for (std::size_t k = 0; k < levels_.size(); ++k)
        best_with_[k][chosen_[k]] = std::max(best_with_[k][chosen_[k]], likely);
      return;
    }
    for (std::size_t k = 0; k < levels_[level].size(); ++k) {
      const std::size_t next = levels_[level][k];
      if (is_taken(all_[next].one) || !append(next)) continue;
      chosen_[level] = k;
      descend(level + 1, likely + log_odds(next, factor_.minus_two_log_density(all_[next].silent_rows)));
      chosen_[level] = levels_[level].size();
      factor_.pop();
      members_.pop_back();
    }
    descend(level + 1, likely);
  }

  bool append(std::size_t next) {
    const Eigen::Index size = all_[next].residual.size();
    const auto block = [&](std::size_t other) -> LocalMatrix {
      return joint_.block(starts_[next], starts_[other], size, all_[other].residual.size());
    };
    const bool added = factor_
                           .append(all_[next].residual, block(next), gates_(size),
                                   [&](std::size_t k) { return block(members_[k]); })
                           .has_value();
    if (added) members_.push_back(next);
    return added;
  }

  const std::vector<TwinCandidate>& all_;
  const Eigen::MatrixXd& joint_;
  const Gates& gates_;
  const FusionOptions& options_;
  std::vector<std::vector<std::size_t>> levels_;
  std::vector<Eigen::Index> starts_;
  std::vector<double> most_from_;
  std::vector<std::vector<double>> best_with_;  ///< by level, and what was chosen there; the last: nothing
  std::vector<std::size_t> chosen_;             ///< by level
  std::vector<std::size_t> members_;
  JointFactor factor_;
  double best_ = 0;
  std::size_t steps_ = 0;
};

}  // namespace

TwinSearch::TwinSearch(const TiedMaps& maps, const LandmarkTree& tree, const FusionOptions& options)
    : tree_(tree), options_(options), gates_(options.probability, 4) {
  for (std::size_t i = 0; i < maps.one.features.size(); ++i)
    largest_sigma_one_ = std::max(largest_sigma_one_, place_sigma_m(maps.one, i));
}

std::vector<TwinCandidate> TwinSearch::candidates(const TiedMaps& maps, const TieFilter& ties,
                                                  std::size_t two, const std::vector<bool>& taken,
                                                  SearchWork& work) const {
  const Feature there = maps.one_from_two * maps.two.features[two].feature;
  const Eigen::Vector2d arm = middle(there) - maps.about;
  const Eigen::Matrix3d put = ties.maps_covariance();
  const Eigen::Vector3d correction = ties.maps_correction();
  const double put_sigma = std::sqrt(put.topLeftCorner<2, 2>().trace() + arm.squaredNorm() * put(2, 2));
  const double sigma = place_sigma_m(maps.two, two) + put_sigma;
  const double half = there.kind == FeatureKind::segment ? 0.5 * length_m(there) + 1 : 0;
  std::vector<TwinCandidate> all;
  for (const std::size_t one :
       tree_.within(middle(there), std::sqrt(gates_(2)) * (sigma + largest_sigma_one_) + half)) {
    if (!work.spend(1)) return {};
    if (taken[one] || !alike(maps.one.features[one].feature, there, sigma, options_)) continue;
    std::optional<MapTie> tie = tie_features(maps, one, two, options_.identity_sigma_m);
    if (!tie) continue;
    TwinCandidate candidate;
    candidate.one = one;
    candidate.two = two;
    candidate.tie = *std::move(tie);
    candidate.silent_rows = there.kind == FeatureKind::segment ? 1 : 0;
    candidate.given = ties.given(candidate.tie);
    candidate.residual = candidate.given.residual - candidate.given.by_maps * correction;
    candidate.covariance =
        candidate.given.covariance + candidate.given.by_maps * put * candidate.given.by_maps.transpose();
    allow_for(put(2, 2) * arm, candidate);
    allow_for(bend_of_arc(maps, put), candidate);
    candidate.squared_distance = candidate.residual.dot(candidate.covariance.llt().solve(candidate.residual));
    if (!(candidate.squared_distance < gates_(candidate.residual.size()))) continue;
    candidate.log_chance = log_chance(maps.one, one, candidate.tie);
    all.push_back(std::move(candidate));
  }
  std::sort(all.begin(), all.end(), [](const TwinCandidate& a, const TwinCandidate& b) {
    return std::pair(a.squared_distance, a.one) < std::pair(b.squared_distance, b.one);
  });
  return all;
}

double TwinSearch::log_chance(const FeatureState& one, std::size_t index, const MapTie& tie) const {
  const Feature& feature = one.features[index].feature;
  const bool is_wall = feature.kind == FeatureKind::segment;
  double count = 0;
  for (const std::size_t other : tree_.within(middle(feature), around_m)) {
    const Feature& beside = one.features[other].feature;
    if (beside.kind != feature.kind) continue;
    count += !is_wall || along(beside).dot(along(feature)) > std::cos(parallel_rad) ? 1 : 0;
  }
  const auto further = static_cast<double>(tie.residual.size() - 2);  // ends, a heading, a radius
  const double room = is_wall ? 2 * around_m : std::numbers::pi * around_m * around_m;
  const double of_further = feature.kind == FeatureKind::corner ? 2 * std::numbers::pi : 2 * around_m;
  return std::log(std::max(1.0, count)) - std::log(room) - further * std::log(of_further);
}

std::vector<std::size_t> TwinSearch::certain(const TiedMaps& maps, const TieFilter& ties,
                                             const std::vector<TwinCandidate>& all, SearchWork& work) const {
  if (all.empty() || !work.spend(all.size() * all.size())) return {};
  std::vector<Eigen::Index> starts{0};
  for (const TwinCandidate& one : all) starts.push_back(starts.back() + one.residual.size());
  const Eigen::Matrix3d put = ties.maps_covariance();
  Eigen::MatrixXd joint(starts.back(), starts.back());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Eigen::Index size = all[i].residual.size();
    joint.block(starts[i], starts[i], size, size) = all[i].covariance;
    for (std::size_t k = 0; k < i; ++k) {
      const LocalMatrix shared =
          cross_covariance(maps.one, maps.two, all[i].tie, all[i].given, all[k].tie, all[k].given) +
          all[i].given.by_maps * put * all[k].given.by_maps.transpose();
      joint.block(starts[i], starts[k], size, shared.cols()) = shared;
      joint.block(starts[k], starts[i], shared.cols(), size) = shared.transpose();
    }
  }
  const GroupSearch::Found found = GroupSearch(all, joint, gates_, options_).certain();
  work.spend(found.steps);
  return found.pairs;
}

}  // namespace isthmus
