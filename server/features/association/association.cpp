#include "server/features/association/association.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "relations/chi_squared.hpp"
#include "server/features/state/measurement.hpp"

namespace isthmus {
namespace {

bool alike(const Feature& seen, const Feature& expected, const AssociationOptions& options) {
  if (expected.kind != seen.kind) return false;
  if (seen.kind == FeatureKind::corner)
    return std::abs(seen.opening_rad - expected.opening_rad) < options.opening_tolerance_rad;
  return overlap(seen, expected, options.free_end_reach_m) >= options.min_overlap;
}

std::optional<Candidate> candidate(const FeatureState& state, int robot,
                                   std::span<const ObservedFeature> seen, std::size_t which,
                                   std::size_t index, const Gates& gates) {
  for (const bool all : {true, false}) {
    std::optional<LinearMeasurement> measurement = measure_feature(state, index, robot, seen[which], all);
    if (!measurement) return std::nullopt;
    const double distance = squared_distance(state.covariance, *measurement);
    if (distance < gates(measurement->residual.size()))
      return Candidate{which, index, *std::move(measurement), distance, !all};
    if (seen[which].feature.kind != FeatureKind::segment || measurement->residual.size() == 2)
      return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

Gates::Gates(double probability, int max_degrees_of_freedom) {
  for (int k = 1; k <= max_degrees_of_freedom; ++k) bounds_.push_back(chi2_quantile(probability, k));
}

double Gates::operator()(Eigen::Index degrees_of_freedom) const {
  const auto k = static_cast<std::size_t>(degrees_of_freedom);
  if (k <= bounds_.size()) return bounds_[k - 1];
  return bounds_.back() * static_cast<double>(k) / static_cast<double>(bounds_.size());
}

double overlap(const Feature& seen, const Feature& expected, double free_end_reach_m) {
  if (seen.kind != FeatureKind::segment) return 1;
  const Eigen::Vector2d t = along(seen);
  const double half = 0.5 * length_m(seen);
  const Eigen::Vector2d middle = 0.5 * (seen.a + seen.b);
  double from = t.dot(expected.a - middle), to = t.dot(expected.b - middle);
  const double shorter = std::min(2 * half, to - from);
  if (!expected.end_a_known) from -= free_end_reach_m;
  if (!expected.end_b_known) to += free_end_reach_m;
  return shorter > 0 ? (std::min(half, to) - std::max(-half, from)) / shorter : 0;
}

std::vector<Candidate> candidates(const FeatureState& state, int robot, std::span<const ObservedFeature> seen,
                                  const AssociationOptions& options, const Gates& gates) {
  const Pose robot_from_map = inverse(state.robots[static_cast<std::size_t>(robot)].map_from_robot);
  std::vector<Candidate> all;
  for (std::size_t which = 0; which < seen.size(); ++which) {
    const std::size_t first = all.size();
    for (std::size_t index = 0; index < state.features.size(); ++index) {
      if (!alike(seen[which].feature, robot_from_map * state.features[index].feature, options)) continue;
      std::optional<Candidate> found = candidate(state, robot, seen, which, index, gates);
      if (found) all.push_back(*std::move(found));
    }
    std::sort(all.begin() + static_cast<std::ptrdiff_t>(first), all.end(),
              [](const Candidate& a, const Candidate& b) {
                return std::pair(a.squared_distance, a.index) < std::pair(b.squared_distance, b.index);
              });
  }
  return all;
}

bool is_like_any(const Feature& feature, const Pose& map_from_robot, std::span<const ObservedFeature> seen,
                 const AssociationOptions& options) {
  const Feature expected = inverse(map_from_robot) * feature;
  return std::any_of(seen.begin(), seen.end(),
                     [&](const ObservedFeature& one) { return alike(one.feature, expected, options); });
}

std::vector<std::size_t> nearest_pairs(std::span<const Candidate> all) {
  std::map<std::size_t, std::size_t> of_feature;
  std::size_t last_seen = static_cast<std::size_t>(-1);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].seen == last_seen) continue;  // candidates come nearest first
    last_seen = all[i].seen;
    const auto [place, is_new] = of_feature.try_emplace(all[i].index, i);
    if (!is_new && all[i].squared_distance < all[place->second].squared_distance) place->second = i;
  }
  std::vector<std::size_t> chosen;
  for (const auto& [feature, which] : of_feature) chosen.push_back(which);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace isthmus
