#include "server/engine/map/weak_link.hpp"

#include <algorithm>

namespace isthmus {
namespace {

/// Tells which relations a patch was placed by: those that follow its odometry, each with it as its newer
/// end.
class Placings {
 public:
  bool has(const Relation& relation) {
    const PatchId newer = std::max(relation.a, relation.b);
    if (relation.origin.kind == OriginKind::odometry) {
      placed_ = newer;
      return false;
    }
    if (relation.origin.kind != OriginKind::match || newer != placed_) placed_ = PatchId{};
    return placed_.valid();
  }

 private:
  PatchId placed_;
};

double cost_of_island(const RelationGraph& graph, IslandId island, std::span<const Pose> poses) {
  double sum = 0;
  for (const auto& [id, relation] : graph.relations()) {
    if (graph.island(relation.a) != island) continue;
    sum += cost(relation, ominus(poses[index(relation.b)], poses[index(relation.a)]));
  }
  return sum;
}

double misfit(const Relation& relation, std::span<const Pose> poses) {
  return chi_squared(relation.measurement, ominus(poses[index(relation.b)], poses[index(relation.a)]));
}

// A slip of one kind leaves what was measured otherwise as it is: odometry may be right where a scan was not.
bool agrees(const Relation& relation, std::span<const Pose> poses, const WeakLinkOptions& options) {
  return misfit(relation, poses) < options.agreeing.value();
}

}  // namespace

std::vector<UncertainLink> uncertain_links(const RelationGraph& graph, IslandId island,
                                           std::span<const Pose> poses, const WeakLinkOptions& options) {
  std::vector<UncertainLink> links;
  Placings placings;
  for (const auto& [id, relation] : graph.relations()) {
    const bool of_placing = placings.has(relation);
    if (graph.island(relation.a) != island) continue;
    const bool odometry = relation.origin.kind == OriginKind::odometry;
    const double sure = odometry ? options.odometry_log_odds : options.match_log_odds;
    links.push_back({id, std::min(relation.a, relation.b), std::max(relation.a, relation.b),
                     std::max(0.0, sure - 0.5 * misfit(relation, poses)), of_placing});
  }
  return links;
}

std::optional<Blame> blame(const OpenLoop& loop, const RelationGraph& before,
                           std::span<const Pose> poses_before, const RelationGraph& fitted, double cost,
                           double max_log_odds, const WeakLinkOptions& options) {
  if (loop.first.empty() || loop.second.empty()) return std::nullopt;
  const IslandId island = before.island(loop.first.front());
  const double bent_by = cost - cost_of_island(before, island, poses_before);
  max_log_odds = std::min(max_log_odds, bent_by);
  if (max_log_odds <= 0) return std::nullopt;
  std::optional<WeakestCut> link =
      weakest_cut(uncertain_links(before, island, poses_before, options), loop.first, loop.second);
  if (!link || link->log_odds > max_log_odds) return std::nullopt;
  std::vector<Pose> poses(poses_before.begin(), poses_before.end());
  for (const PatchId id : link->beyond) poses[index(id)] = loop.first_from_second * poses[index(id)];
  RelationGraph without = fitted;
  without.remove(link->relations);
  const FitReport report = fit_island(without, island, poses);
  if (!report.ok || cost - report.cost_after < link->log_odds) return std::nullopt;
  std::vector<RelationId> wrong = link->relations;
  std::erase_if(wrong, [&](RelationId id) { return agrees(*fitted.find(id), poses, options); });
  if (wrong.size() < link->relations.size()) {
    without = fitted;
    without.remove(wrong);
    if (!fit_island(without, island, poses).ok) return std::nullopt;
  }
  return Blame{*std::move(link), std::move(wrong), std::move(poses)};
}

}  // namespace isthmus
