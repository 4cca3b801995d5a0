#include "server/features/fusion/fusion.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "server/features/fusion/joined_maps.hpp"
#include "server/features/fusion/twin_search.hpp"
#include "server/features/state/growth.hpp"

namespace isthmus {
namespace {

/// The two that met, and how.
struct WhoMet {
  PoseOwner robot_1;
  PoseOwner robot_2;
  RobotAlignment alignment;
};

/// Two maps, the pairs found so far, and what these tell together with the sighting.
class Joining {
 public:
  Joining(const FeatureState& one, const FeatureState& two, const WhoMet& met, const FusionOptions& options)
      : maps_{one, two, {}, {}, {}},
        met_(met),
        options_(options),
        ties_(one, two),
        taken_(one.features.size(), false) {
    const Pose& first = pose_in(one, met.robot_1).map_from_robot;
    const Pose& second = pose_in(two, met.robot_2).map_from_robot;
    maps_.one_from_two = first * met.alignment.one_from_two * inverse(second);
    maps_.about = position(first * met.alignment.one_from_two);
    maps_.seen_from = met.alignment.is_polar ? position(first) : maps_.about;
    tie_all();
  }

  Joining(const FeatureState& one, const FeatureState& two, const Pose& one_from_two,
          std::span<const TwinSeed> seeds, const FusionOptions& options)
      : maps_{one, two, one_from_two, Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()},
        options_(options),
        ties_(one, two),
        taken_(one.features.size(), false) {
    for (const TwinSeed& seed : seeds) {
      maps_.about += middle(one.features[seed.one].feature) / static_cast<double>(seeds.size());
      if (taken_[seed.one]) continue;
      pairs_.push_back(seed);
      taken_[seed.one] = true;
    }
    maps_.seen_from = maps_.about;
    tie_all();
    follow();
  }

  /// Whether the ties tell where the second map lies.
  bool is_placed() const {
    if (ties_.rows() < 3) return false;
    const Eigen::Matrix3d covariance = ties_.maps_covariance();
    return covariance.allFinite() && covariance.diagonal().minCoeff() > 0 &&
           covariance.diagonal().maxCoeff() < 1;
  }

  const TiedMaps& maps() const { return maps_; }
  const TieFilter& ties() const { return ties_; }
  const std::vector<bool>& taken() const { return taken_; }
  const std::vector<TwinSeed>& pairs() const { return pairs_; }

  void add(const TwinCandidate& found) {
    if (taken_[found.one] || !ties_.append(found.tie)) return;
    pairs_.push_back({found.one, found.two});
    taken_[found.one] = true;
  }

  /// Where the ties turn the second map, by itself or about the robot that saw the other, they are taken anew
  /// about its new place (Gauss and Newton).
  void follow() {
    const double range = std::max(1.0, (maps_.about - maps_.seen_from).norm());
    for (int step = 0; step < max_steps; ++step) {
      const Eigen::Vector3d delta = ties_.maps_correction();
      if (!(std::max(std::abs(delta.z()), delta.head<2>().norm() / range) > options_.linear_rad)) return;
      maps_.one_from_two = maps_.moved(delta);
      tie_all();
    }
  }

  /// Pairs that all other ties contradict go, the worst first.
  void drop_contradicted(const Gates& gates) {
    while (const std::optional<std::size_t> worst = contradicted(gates)) {
      taken_[pairs_[*worst].one] = false;
      pairs_.erase(pairs_.begin() + static_cast<std::ptrdiff_t>(*worst));
      tie_all();
      follow();
    }
  }

  /// The same pairs with another state of the first map, whose features are the same.
  Joining with(const FeatureState& one) const {
    if (!met_) {
      Joining other(one, maps_.two, maps_.one_from_two, pairs_, options_);
      other.maps_.about = other.maps_.seen_from = maps_.about;
      other.tie_all();
      return other;
    }
    Joining other(one, maps_.two, *met_, options_);
    other.maps_.one_from_two = maps_.one_from_two;
    other.pairs_ = pairs_;
    other.taken_ = taken_;
    other.tie_all();
    return other;
  }

 private:
  static constexpr int max_steps = 5;  // two are enough

  void tie_all() {
    ties_.clear();
    if (met_) ties_.append(tie_robots(maps_, met_->robot_1, met_->robot_2, met_->alignment));
    std::erase_if(pairs_, [&](const TwinSeed& pair) {
      const std::optional<MapTie> tie = tie_features(maps_, pair.one, pair.two, options_.identity_sigma_m);
      if (tie && ties_.append(*tie)) return false;
      taken_[pair.one] = false;
      return true;
    });
  }

  /// The pair beyond its gate that the others put farthest apart: S⁻¹, the second map's place being unknown,
  /// has what each says given all others on its diagonal.
  std::optional<std::size_t> contradicted(const Gates& gates) const {
    const Eigen::Index rows = ties_.rows();
    const Eigen::MatrixXd white =
        ties_.factor().triangularView<Eigen::Lower>().solve(Eigen::MatrixXd::Identity(rows, rows));
    const Eigen::MatrixXd by = white.transpose() * ties_.by_maps();
    const Eigen::Matrix3d place = ties_.maps_covariance();
    const Eigen::VectorXd pull =
        white.transpose() * (ties_.residual() - ties_.by_maps() * ties_.maps_correction());
    std::optional<std::size_t> worst;
    double most = 1;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      const std::size_t tie = i + (met_ ? 1 : 0);
      const Eigen::Index at = ties_.starts()[tie];
      const Eigen::Index size = (tie + 1 < ties_.starts().size() ? ties_.starts()[tie + 1] : rows) - at;
      const Eigen::MatrixXd own_white = white.middleCols(at, size);
      const LocalMatrix own = own_white.transpose() * own_white -
                              by.middleRows(at, size) * place * by.middleRows(at, size).transpose();
      const LocalVector force = pull.segment(at, size);
      const double share = force.dot(own.llt().solve(force)) / gates(size);
      if (!(share > most)) continue;
      most = share;
      worst = i;
    }
    return worst;
  }

  TiedMaps maps_;
  std::optional<WhoMet> met_;
  FusionOptions options_;
  TieFilter ties_;
  std::vector<bool> taken_;  ///< features of the first map
  std::vector<TwinSeed> pairs_;
};

/// Features of the second map without a twin, from the rendezvous outwards.
std::vector<std::size_t> outwards(const Joining& joining) {
  const TiedMaps& maps = joining.maps();
  std::set<std::size_t> seeds;
  for (const TwinSeed& pair : joining.pairs()) seeds.insert(pair.two);
  std::vector<std::pair<double, std::size_t>> by_distance;
  for (std::size_t i = 0; i < maps.two.features.size(); ++i) {
    if (seeds.contains(i)) continue;
    const Eigen::Vector2d arm = maps.one_from_two * middle(maps.two.features[i].feature) - maps.about;
    by_distance.emplace_back(arm.squaredNorm(), i);
  }
  std::sort(by_distance.begin(), by_distance.end());
  std::vector<std::size_t> order;
  for (const auto& [distance, index] : by_distance) order.push_back(index);
  return order;
}

/// Pairs what is certain of `order`, a group at a time; returns what had candidates and stayed open.
std::vector<std::size_t> pair_up(Joining& joining, const TwinSearch& search,
                                 const std::vector<std::size_t>& order, const FusionOptions& options,
                                 SearchWork& work) {
  std::vector<std::size_t> open;
  std::vector<TwinCandidate> group;
  std::vector<std::size_t> members;
  for (std::size_t k = 0; k < order.size(); ++k) {
    std::vector<TwinCandidate> own =
        search.candidates(joining.maps(), joining.ties(), order[k], joining.taken(), work);
    if (!own.empty()) members.push_back(order[k]);
    for (TwinCandidate& one : own) group.push_back(std::move(one));
    if (members.empty() || (members.size() < options.at_once && k + 1 < order.size())) continue;
    std::vector<std::size_t> waiting = std::exchange(members, {});
    for (const std::size_t which : search.certain(joining.maps(), joining.ties(), group, work)) {
      joining.add(group[which]);
      std::erase(waiting, group[which].two);
    }
    joining.follow();
    open.insert(open.end(), waiting.begin(), waiting.end());
    group.clear();
  }
  return open;
}

/// The first map with what its twins know more of its features: an end, a heading, a radius. Nothing where
/// they know no more.
std::optional<FeatureState> learned(const Joining& joining, double end_slack_m) {
  std::optional<FeatureState> state;
  const TiedMaps& maps = joining.maps();
  for (const TwinSeed& pair : joining.pairs()) {
    const Feature there = maps.one_from_two * maps.two.features[pair.two].feature;
    const auto known = known_components(maps.one.features[pair.one].feature),
               others = known_components(there);
    const bool is_more = std::ranges::any_of(std::array{2, 3}, [&](int k) {
      return others[static_cast<std::size_t>(k)] && !known[static_cast<std::size_t>(k)];
    });
    if (!is_more) continue;
    if (!state) state = maps.one;
    learn_from(*state, pair.one, there, end_slack_m);
  }
  return state;
}

Fusion fusion_of(const Joining& joining) {
  const TiedMaps& maps = joining.maps();
  Fusion fusion;
  std::vector<bool> gone(maps.two.features.size(), false);
  for (const TwinSeed& pair : joining.pairs()) gone[pair.two] = true;
  fusion.state = joined_maps(maps, joining.ties(), gone);
  const Eigen::Vector3d delta = joining.ties().maps_correction();
  const Pose place = fusion.one_from_two = maps.moved(delta);
  for (const TwinSeed& pair : joining.pairs()) {
    const FeatureInState& twin = maps.two.features[pair.two];
    fusion.duplicates.push_back({maps.one.features[pair.one].id, twin.id + maps.one.next_id});
    fusion.state.features[pair.one].seen += twin.seen;
    reach_to(fusion.state, pair.one, place * twin.feature);
  }
  fusion.squared_distance = (joining.ties().residual() - joining.ties().by_maps() * delta).squaredNorm();
  fusion.degrees_of_freedom = static_cast<int>(joining.ties().rows()) - 3;
  return fusion;
}

/// Twins from what ties the maps outwards; then they are one.
Fusion completed(Joining& joining, const FusionOptions& options) {
  const TiedMaps& maps = joining.maps();
  std::vector<Feature> features;
  for (const FeatureInState& entry : maps.one.features) features.push_back(entry.feature);
  const LandmarkTree tree(features);
  const TwinSearch search(maps, tree, options);
  SearchWork work(options.steps_per_feature * maps.two.features.size());
  std::vector<std::size_t> open = outwards(joining);
  for (std::size_t before = open.size() + 1; !open.empty() && open.size() < before;) {
    before = open.size();
    open = pair_up(joining, search, open, options, work);
  }
  joining.drop_contradicted(Gates(options.probability, 4));
  const std::optional<FeatureState> more = learned(joining, options.association.end_slack_m);
  Fusion fusion = fusion_of(more ? joining.with(*more) : joining);
  fusion.came_to_end = work.left() > 0;
  return fusion;
}

}  // namespace

Fusion fuse(const FeatureState& one, PoseOwner robot_1, const FeatureState& two, PoseOwner robot_2,
            const RobotAlignment& alignment, const FusionOptions& options) {
  Joining joining(one, two, {robot_1, robot_2, alignment}, options);
  return completed(joining, options);
}

std::optional<Fusion> fuse(const FeatureState& one, const FeatureState& two, const Pose& one_from_two,
                           std::span<const TwinSeed> seeds, const FusionOptions& options) {
  Joining joining(one, two, one_from_two, seeds, options);
  joining.drop_contradicted(Gates(options.probability, 4));
  if (!joining.is_placed()) return std::nullopt;
  return completed(joining, options);
}

}  // namespace isthmus
