#include "tools/simulate/campaigns/sightings/closures.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <tuple>

#include "relations/chi_squared.hpp"
#include "tools/simulate/campaigns/confidence/confidence.hpp"
#include "tools/simulate/campaigns/sightings/sightings.hpp"
#include "tools/simulate/truth/true_patches.hpp"
#include "tools/simulate/truth/truth_files.hpp"

namespace isthmus {
namespace {

constexpr double wrong_from_m = 1;
constexpr double wrong_from_rad = 20 * std::numbers::pi / 180;
/// Beyond this a relation leaves no room for the truth: true ones lie within it but for 1.5 in 100,000.
double excluded() {
  static const double bound = chi2_quantile(0.999985, 3);
  return bound;
}
constexpr std::int64_t same_time_us = 10'000'000;

using TruePatches = std::vector<std::optional<TruePatch>>;

struct Off {
  double m = 0;
  double rad = 0;
  bool is_wrong() const { return m > wrong_from_m || rad > wrong_from_rad; }
};

Off off(const Pose& said, const Pose& truth) {
  return {std::hypot(said.x - truth.x, said.y - truth.y), std::abs(wrap_angle(said.yaw - truth.yaw))};
}

// How far what a relation says is from the truth. Directions of which it says little are taken as true: what
// counts is how far it would pull from the truth a pose that is known there to half a metre and ten degrees.
Off off(const Relation& relation, const Pose& true_a_from_b) {
  if (chi_squared(relation.measurement, true_a_from_b) < excluded()) return {};
  Pose said = minimiser(relation.measurement, true_a_from_b);
  const auto* correspondences = std::get_if<Correspondences>(&relation.measurement);
  // The minimum nearest to the truth may be another than what the relation means.
  if (correspondences != nullptr && chi_squared(relation.measurement, said) > excluded())
    said = correspondences->least.a_from_b;
  const Eigen::Matrix3d pull = information(relation.measurement, said);
  Eigen::Matrix3d hold = Eigen::Matrix3d::Zero();
  hold.diagonal() << 1 / (0.5 * 0.5), 1 / (0.5 * 0.5), 1 / (0.17 * 0.17);
  const Eigen::Vector3d pulled = (pull + hold).ldlt().solve(pull * wrapped_difference(said, true_a_from_b));
  return {pulled.head<2>().norm(), std::abs(pulled.z())};
}

bool is_from_scans(const Relation& relation) {
  return relation.origin.kind == OriginKind::match || relation.origin.kind == OriginKind::propagation ||
         relation.origin.kind == OriginKind::hypothesis;
}

bool are_near(const Patch& a, const Patch& b) {
  return a.robot == b.robot && std::abs(a.utime - b.utime) <= same_time_us;
}

// Each wrong relation that is not between the places of one before it.
std::size_t count_closures(const MapCopy& map, const std::vector<WrongRelation>& wrong) {
  std::vector<WrongRelation> apart;
  for (const WrongRelation& one : wrong) {
    const Patch &a = *map.patches[index(one.a)], &b = *map.patches[index(one.b)];
    const bool known = std::ranges::any_of(apart, [&](const WrongRelation& other) {
      const Patch &c = *map.patches[index(other.a)], &d = *map.patches[index(other.b)];
      return (are_near(a, c) && are_near(b, d)) || (are_near(a, d) && are_near(b, c));
    });
    if (!known) apart.push_back(one);
  }
  return apart.size();
}

// The patches of each stretch of each robot, by island.
std::map<std::tuple<IslandId, std::size_t, std::size_t>, std::vector<PatchId>> by_stretch(
    const MapCopy& map, const TruePatches& truth) {
  std::map<std::tuple<IslandId, std::size_t, std::size_t>, std::vector<PatchId>> stretches;
  for (const std::vector<PatchId>& island : map.graph.islands()) {
    for (const PatchId patch : island) {
      const auto& at = truth[index(patch)];
      if (at) stretches[{island.front(), at->robot, at->stretch}].push_back(patch);
    }
  }
  return stretches;
}

// Whether two stretches lie wrongly to one another, judged where they truly come nearest.
bool are_joined_wrongly(const MapCopy& map, const TruePatches& truth, const std::vector<PatchId>& first,
                        const std::vector<PatchId>& second) {
  double nearest_m = std::numeric_limits<double>::infinity();
  Off there;
  for (const PatchId a : first) {
    for (const PatchId b : second) {
      const Pose true_a_from_b = ominus(truth[index(b)]->world_from_patch, truth[index(a)]->world_from_patch);
      const double distance_m = std::hypot(true_a_from_b.x, true_a_from_b.y);
      if (distance_m >= nearest_m) continue;
      nearest_m = distance_m;
      there = off(ominus(map.poses[index(b)], map.poses[index(a)]), true_a_from_b);
    }
  }
  return there.is_wrong();
}

std::size_t count_wrong_merges(const MapCopy& map, const TruePatches& truth) {
  std::size_t wrong = 0;
  const auto stretches = by_stretch(map, truth);
  for (auto a = stretches.begin(); a != stretches.end(); ++a) {
    for (auto b = std::next(a); b != stretches.end() && std::get<0>(b->first) == std::get<0>(a->first); ++b) {
      if (are_joined_wrongly(map, truth, a->second, b->second)) ++wrong;
    }
  }
  return wrong;
}

}  // namespace

ClosureScore judge_closures(const MapCopy& map, const std::vector<RobotTruth>& truth) {
  const TruePatches patches = true_patches(map, truth);
  ClosureScore score;
  score.islands = map.graph.islands().size();
  for (const auto& [id, relation] : map.graph.relations()) {
    const auto &a = patches[index(relation.a)], &b = patches[index(relation.b)];
    if (!is_from_scans(relation) || !a || !b) continue;
    ++score.relations;
    const Off one = off(relation, ominus(b->world_from_patch, a->world_from_patch));
    if (one.is_wrong())
      score.wrong.push_back({id, relation.a, relation.b, relation.origin.kind, one.m, one.rad});
  }
  score.wrong_closures = count_closures(map, score.wrong);
  score.wrong_merges = count_wrong_merges(map, patches);
  return score;
}

ClosureTrial try_closures(const Scenario& scenario, std::uint64_t seed, const Configuration& configuration) {
  const SimulatedRun run = simulate(scenario, seed);
  const MapCopy map = map_events(run.events, configuration);
  ClosureTrial trial;
  trial.seed = seed;
  trial.score = judge_closures(map, run.truth);
  for (const ClosureRecord& closure : map.closures)
    if (closure.state == ClosureState::accepted) ++trial.closures_accepted;
  const RelationComparison errors = compare(sample_relations(run.truth, seed), map, map);
  trial.compared = errors.compared;
  trial.missing = errors.missing;
  trial.mean_error_m = errors.mean_m;
  return trial;
}

bool is_worse(const ClosureTrial& a, const ClosureTrial& b) {
  const auto rank = [](const ClosureTrial& t) {
    return std::tuple(t.score.wrong_closures + t.score.wrong_merges, t.mean_error_m);
  };
  return rank(a) > rank(b);
}

}  // namespace isthmus
