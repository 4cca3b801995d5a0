#include "relations/fit_problem.hpp"

#include <algorithm>
#include <numeric>

#include "relations/disjoint_sets.hpp"

namespace isthmus {
namespace {

/// Places of the first patch of each connected part that no held patch touches: the gauges.
std::vector<bool> find_gauges(const FitProblem& problem) {
  std::vector<int> parent(problem.patches.size());
  std::iota(parent.begin(), parent.end(), 0);
  DisjointSets<int> parts(parent);
  std::vector<bool> has_border(parent.size(), false);
  for (const FitProblem::Link& link : problem.links) {
    if (!problem.is_free(link.a) || !problem.is_free(link.b)) continue;
    parts.join(link.a, link.b);
  }
  for (const FitProblem::Link& link : problem.links)
    for (const auto& [end, other] : {std::pair(link.a, link.b), std::pair(link.b, link.a)})
      if (!problem.is_free(other)) has_border[at(parts.lowest(end))] = true;
  std::vector<bool> gauge(parent.size(), false);
  for (int place = 0; place < problem.free_count; ++place)
    gauge[at(place)] = parent[at(place)] == place && !has_border[at(place)];
  return gauge;
}

/// Moves the gauges behind the free patches, the order kept otherwise.
void hold_gauges(FitProblem& problem) {
  std::vector<bool> held = find_gauges(problem);
  std::fill(held.begin() + problem.free_count, held.end(), true);
  std::vector<PatchId> ordered;
  std::vector<int> moved(held.size());
  ordered.reserve(held.size());
  for (const bool pass : {false, true}) {
    for (std::size_t i = 0; i < held.size(); ++i) {
      if (held[i] != pass) continue;
      moved[i] = static_cast<int>(ordered.size());
      ordered.push_back(problem.patches[i]);
    }
    if (!pass) problem.free_count = static_cast<int>(ordered.size());
  }
  problem.patches = std::move(ordered);
  for (FitProblem::Link& link : problem.links) {
    link.a = moved[at(link.a)];
    link.b = moved[at(link.b)];
  }
  std::erase_if(problem.links, [&](const FitProblem::Link& link) {
    return !problem.is_free(link.a) && !problem.is_free(link.b);
  });
}

}  // namespace

FitProblem make_fit_problem(const RelationGraph& graph, std::span<const PatchId> free) {
  FitProblem problem;
  std::vector<int> place(graph.patch_count(), -1);
  for (const PatchId patch : free) {
    if (place[index(patch)] >= 0 || graph.of(patch).empty()) continue;
    place[index(patch)] = static_cast<int>(problem.patches.size());
    problem.patches.push_back(patch);
  }
  problem.free_count = static_cast<int>(problem.patches.size());
  for (int i = 0; i < problem.free_count; ++i) {
    const PatchId patch = problem.patches[at(i)];
    for (const RelationId id : graph.of(patch)) {
      const Relation* relation = graph.find(id);
      const PatchId other = relation->a == patch ? relation->b : relation->a;
      int& other_place = place[index(other)];
      if (other_place < 0) {
        other_place = static_cast<int>(problem.patches.size());
        problem.patches.push_back(other);
      }
      // A relation between two free patches is met from both ends: it is taken at its a.
      if (relation->a == patch || !problem.is_free(other_place))
        problem.links.push_back({relation, place[index(relation->a)], place[index(relation->b)]});
    }
  }
  hold_gauges(problem);
  return problem;
}

std::vector<Pose> poses_of(const FitProblem& problem, std::span<const Pose> by_patch_id) {
  std::vector<Pose> poses;
  poses.reserve(problem.patches.size());
  for (const PatchId patch : problem.patches) poses.push_back(by_patch_id[index(patch)]);
  return poses;
}

double cost(const FitProblem& problem, std::span<const Pose> poses) {
  double sum = 0;
  for (const FitProblem::Link& link : problem.links)
    sum += cost(*link.relation, ominus(poses[at(link.b)], poses[at(link.a)]));
  return sum;
}

}  // namespace isthmus
