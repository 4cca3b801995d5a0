#include "server/features/fusion.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <nanoflann.hpp>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "server/features/growth.hpp"
#include "server/features/measurement.hpp"

namespace isthmus {
namespace {

/// On FusionOptions::at_once: larger groups are slower, and sometimes tell apart what smaller ones do not.
constexpr std::array<std::size_t, 3> group_factors = {1, 2, 4};

/// Points along features of the first map, for the kd-tree: a segment has one each metre.
struct Landmarks {
  std::vector<Eigen::Vector2d> points;
  std::vector<std::size_t> feature;  ///< index in the state, of each point

  // As nanoflann asks for it.
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[i][static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

Landmarks landmarks_of(const FeatureState& state, std::size_t count) {
  Landmarks all;
  for (std::size_t i = 0; i < count; ++i) {
    const Feature& feature = state.features[i].feature;
    const bool is_long = feature.kind == FeatureKind::segment;
    const int pieces = is_long ? std::max(1, static_cast<int>(std::ceil(length_m(feature)))) : 0;
    for (int k = 0; k <= pieces; ++k) {
      const double share = is_long ? static_cast<double>(k) / pieces : 0;
      all.points.push_back(is_long ? Eigen::Vector2d(feature.a + share * (feature.b - feature.a))
                                   : feature.a);
      all.feature.push_back(i);
    }
  }
  return all;
}

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Landmarks>, Landmarks,
                                                 2, std::uint32_t>;

/// The search for duplicates in an aligned state, which each one found corrects.
class DuplicateSearch {
 public:
  DuplicateSearch(Fusion& fusion, std::size_t first_count, const FusionOptions& options)
      : fusion_(fusion),
        state_(fusion.state),
        first_count_(first_count),
        options_(options),
        gates_(options.probability) {}

  void run(const Eigen::Vector2d& rendezvous) {
    std::vector<std::size_t> order;
    for (std::size_t i = first_count_; i < state_.features.size(); ++i) order.push_back(i);
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return (middle(a) - rendezvous).squaredNorm() < (middle(b) - rendezvous).squaredNorm();
    });
    pair_all(order);
    pair_all(std::exchange(waiting_, {}));
  }

 private:
  void pair_all(const std::vector<std::size_t>& order) {
    for (std::size_t from = 0; from < order.size(); from += options_.at_once) {
      const std::size_t to = std::min(order.size(), from + options_.at_once);
      pair_group(std::span(order).subspan(from, to - from));
    }
  }

  Eigen::Vector2d middle(std::size_t index) const {
    const Feature& feature = state_.features[index].feature;
    return feature.kind == FeatureKind::segment ? Eigen::Vector2d(0.5 * (feature.a + feature.b)) : feature.a;
  }

  /// Of its place, or of a segment's line and middle along it as far as known.
  double largest_sigma(std::size_t index) const {
    const LocalMatrix by = project_to_feature(state_.features[index].feature).topRows<2>();
    return std::sqrt((by * feature_covariance(state_, index) * by.transpose()).trace());
  }

  void pair_group(std::span<const std::size_t> group) {
    const Landmarks landmarks = landmarks_of(state_, first_count_);
    Tree tree(2, landmarks);
    tree.buildIndex();
    double first_sigma = 0;
    for (std::size_t i = 0; i < first_count_; ++i) first_sigma = std::max(first_sigma, largest_sigma(i));
    std::vector<Candidate> all;
    for (const std::size_t index : group) {
      std::vector<Candidate> own = candidates_of(index, landmarks, tree, first_sigma);
      const bool ambiguous =
          own.size() > 1 && own[1].squared_distance < own[0].squared_distance + options_.ambiguity;
      if (ambiguous) {
        waiting_.push_back(index);
        continue;
      }
      for (Candidate& one : own) all.push_back(std::move(one));
    }
    const std::vector<std::size_t> chosen =
        largest_compatible(state_.covariance, all, options_.association, gates_);
    const Fusion before = fusion_;
    const std::set<std::size_t> taken_before = taken_;
    bool is_supported = chosen.empty();
    for (const std::size_t which : chosen) is_supported = accept(all[which], tree) || is_supported;
    if (is_supported) return;
    fusion_ = before;  // no pair that chance may not have made
    taken_ = taken_before;
  }

  std::vector<Candidate> candidates_of(std::size_t index, const Landmarks& landmarks, const Tree& tree,
                                       double first_sigma) {
    const Feature& feature = state_.features[index].feature;
    const double half = feature.kind == FeatureKind::segment ? 0.5 * length_m(feature) + 1 : 0;
    const double radius = std::sqrt(gates_(2)) * (largest_sigma(index) + first_sigma) + half;
    const Eigen::Vector2d centre = middle(index);
    std::vector<std::pair<std::uint32_t, double>> found;
    tree.radiusSearch(centre.data(), radius * radius, found, nanoflann::SearchParams());
    std::set<std::size_t> twins;
    for (const auto& [point, squared] : found) twins.insert(landmarks.feature[point]);
    std::vector<Candidate> all;
    for (const std::size_t twin : twins) {
      if (taken_.contains(twin) || !alike(twin, index)) continue;
      auto measurement = measure_identity(state_, twin, index, options_.identity_sigma_m);
      if (!measurement) continue;
      const double distance = squared_distance(state_.covariance, *measurement);
      if (distance < gates_(measurement->residual.size()))
        all.push_back({index, twin, *std::move(measurement), distance, false});
    }
    std::sort(all.begin(), all.end(), [](const Candidate& a, const Candidate& b) {
      return std::pair(a.squared_distance, a.index) < std::pair(b.squared_distance, b.index);
    });
    return all;
  }

  bool alike(std::size_t twin, std::size_t index) const {
    const Feature &one = state_.features[twin].feature, &other = state_.features[index].feature;
    if (one.kind != other.kind || (one.kind == FeatureKind::point && !options_.points)) return false;
    if (one.kind == FeatureKind::corner)
      return std::abs(one.opening_rad - other.opening_rad) < options_.association.opening_tolerance_rad;
    return one.kind != FeatureKind::segment ||
           overlap(one, other, largest_sigma(index)) >= options_.association.min_overlap;
  }

  /// Measured anew, for those accepted before it have corrected the state. Whether it is one that chance
  /// would hardly have made.
  bool accept(const Candidate& pair, const Tree& tree) {
    learn_from(state_, pair.index, state_.features[pair.seen].feature, options_.association.end_slack_m);
    const auto identity = measure_identity(state_, pair.index, pair.seen, options_.identity_sigma_m);
    if (!identity) return false;
    const double distance = squared_distance(state_.covariance, *identity);
    const double by_chance = expected_by_chance(pair, *identity, tree);
    if (distance >= gates_(identity->residual.size()) || !correct(state_, {&*identity, 1})) return false;
    fusion_.squared_distance += distance;
    fusion_.degrees_of_freedom += static_cast<int>(identity->residual.size());
    fusion_.duplicates.push_back({state_.features[pair.index].id, state_.features[pair.seen].id});
    state_.features[pair.index].seen += state_.features[pair.seen].seen;
    reach_to(state_, pair.index, state_.features[pair.seen].feature);
    taken_.insert(pair.index);
    return by_chance < options_.max_by_chance;
  }

  /// How many landmarks of the first map would lie within the gate by chance: their density within 5 m, times
  /// its area. A segment's direction and line are seldom met by chance.
  double expected_by_chance(const Candidate& pair, const LinearMeasurement& identity,
                            const Tree& tree) const {
    if (state_.features[pair.seen].feature.kind == FeatureKind::segment) return 0;
    constexpr double around_m = 5;
    std::vector<std::pair<std::uint32_t, double>> found;
    const Eigen::Vector2d place = state_.features[pair.index].feature.a;
    tree.radiusSearch(place.data(), around_m * around_m, found, nanoflann::SearchParams());
    const double density = static_cast<double>(found.size()) / (std::numbers::pi * around_m * around_m);
    const LocalMatrix s = innovation_covariance(state_.covariance, identity);
    const double area = std::numbers::pi * gates_(2) * std::sqrt(s(0, 0) * s(1, 1) - s(0, 1) * s(1, 0));
    return density * area;
  }

  Fusion& fusion_;
  FeatureState& state_;
  std::size_t first_count_;
  const FusionOptions& options_;
  Gates gates_;
  std::set<std::size_t> taken_;
  std::vector<std::size_t> waiting_;
};

/// A prior so wide says a hundredth of what the sighting says.
constexpr double wide = 100;

/// Both maps aligned where a first pass found them to lie, and all that is known of how they do: the sighting
/// as one measurement, then each pair.
struct Joined {
  FeatureState state;
  std::vector<LinearMeasurement> measurements;
};
Joined join(const Fusion& fusion, const FeatureState& one, int robot_1, const FeatureState& two, int robot_2,
            const RobotAlignment& alignment, const Pose& found, const FusionOptions& options) {
  const int met = static_cast<int>(one.robots.size()) + robot_2;
  Joined joined{aligned(one, robot_1, two, robot_2, {found, wide * alignment.covariance}), {}};
  FeatureState& state = joined.state;
  for (const Fusion::Duplicate& pair : fusion.duplicates)
    learn_from(state, *index_of(state, pair.kept), state.features[*index_of(state, pair.gone)].feature,
               options.association.end_slack_m);
  joined.measurements.push_back(
      measure_relative_pose(state, robot_1, met, alignment.one_from_two, alignment.covariance));
  for (const Fusion::Duplicate& pair : fusion.duplicates) {
    auto identity = measure_identity(state, *index_of(state, pair.kept), *index_of(state, pair.gone),
                                     options.identity_sigma_m);
    if (identity) joined.measurements.push_back(*std::move(identity));
  }
  return joined;
}

/// The pair that all other measurements contradict most, beyond its gate: its squared distance given them.
std::optional<std::size_t> contradicted_pair(const Joined& joined, const Gates& gates) {
  const auto& all = joined.measurements;
  std::vector<Eigen::Index> at{0};
  for (const LinearMeasurement& one : all) at.push_back(at.back() + one.residual.size());
  Eigen::MatrixXd s(at.back(), at.back());
  Eigen::VectorXd residual(at.back());
  for (std::size_t i = 0; i < all.size(); ++i) {
    residual.segment(at[i], all[i].residual.size()) = all[i].residual;
    for (std::size_t k = 0; k < all.size(); ++k)
      s.block(at[i], at[k], all[i].residual.size(), all[k].residual.size()) =
          cross_covariance(joined.state.covariance, all[i], all[k]);
    s.block(at[i], at[i], all[i].residual.size(), all[i].residual.size()) += all[i].noise;
  }
  const Eigen::MatrixXd inverse = s.llt().solve(Eigen::MatrixXd::Identity(s.rows(), s.cols()));
  const Eigen::VectorXd pull = inverse * residual;
  std::optional<std::size_t> worst;
  double most = 1;
  for (std::size_t i = 1; i < all.size(); ++i) {
    const Eigen::Index size = all[i].residual.size();
    const LocalMatrix own = inverse.block(at[i], at[i], size, size);
    const LocalVector by = pull.segment(at[i], size);
    const double share = by.dot(own.llt().solve(by)) / gates(size);
    if (share <= most) continue;
    most = share;
    worst = i - 1;
  }
  return worst;
}

/// The duplicates once more in maps aligned where the first pass found them to lie: nothing is compared by an
/// alignment that is degrees off. Pairs that all others contradict go. False where that cannot be solved.
bool fuse_again(Fusion& fusion, const FeatureState& one, int robot_1, const FeatureState& two, int robot_2,
                const RobotAlignment& alignment, const FusionOptions& options) {
  const std::size_t met = one.robots.size() + static_cast<std::size_t>(robot_2);
  const Pose found = ominus(fusion.state.robots[met].map_from_robot,
                            fusion.state.robots[static_cast<std::size_t>(robot_1)].map_from_robot);
  const Gates gates(options.probability, 4);
  Joined joined = join(fusion, one, robot_1, two, robot_2, alignment, found, options);
  while (joined.measurements.size() == fusion.duplicates.size() + 1) {
    const std::optional<std::size_t> worst = contradicted_pair(joined, gates);
    if (!worst) break;
    fusion.duplicates.erase(fusion.duplicates.begin() + static_cast<std::ptrdiff_t>(*worst));
    joined = join(fusion, one, robot_1, two, robot_2, alignment, found, options);
  }
  FeatureState& state = joined.state;
  if (!correct(state, joined.measurements)) return false;
  for (const Fusion::Duplicate& pair : fusion.duplicates) {
    const std::size_t kept = *index_of(state, pair.kept), gone = *index_of(state, pair.gone);
    state.features[kept].seen += state.features[gone].seen;
    reach_to(state, kept, state.features[gone].feature);
  }
  fusion.state = std::move(state);
  return true;
}

}  // namespace

Fusion fuse(const FeatureState& one, int robot_1, const FeatureState& two, int robot_2,
            const RobotAlignment& alignment, const FusionOptions& options) {
  Fusion fusion;
  fusion.state = aligned(one, robot_1, two, robot_2, alignment);
  const std::size_t met = one.robots.size() + static_cast<std::size_t>(robot_2);
  const Eigen::Vector2d rendezvous = position(fusion.state.robots[met].map_from_robot);
  const FeatureState start = fusion.state;
  for (const std::size_t times : group_factors) {
    Fusion other;
    other.state = start;
    FusionOptions larger = options;
    larger.at_once *= times;
    DuplicateSearch(other, one.features.size(), larger).run(rendezvous);
    if (other.duplicates.size() > fusion.duplicates.size()) fusion = std::move(other);
  }
  if (!fusion.duplicates.empty()) fuse_again(fusion, one, robot_1, two, robot_2, alignment, options);
  for (const Fusion::Duplicate& pair : fusion.duplicates)
    remove_feature(fusion.state, *index_of(fusion.state, pair.gone));
  return fusion;
}

}  // namespace isthmus
