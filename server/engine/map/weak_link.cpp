#include "server/engine/map/weak_link.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "server/engine/map/dependencies.hpp"
#include "server/engine/map/slip_density.hpp"

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

// What relations cost by their noise alone, where the map had their patches before, and so much as three
// degrees of freedom cost at most: whoever takes them away saves that, whether they were wrong or not.
double cost_of_noise(const Contradiction& map, std::span<const RelationId> relations) {
  constexpr double expected = 0.5 * 3;
  double sum = 0;
  for (const RelationId id : relations) {
    const Relation& its = *map.before.find(id);
    sum +=
        std::min(expected, cost(its, ominus(map.poses_before[index(its.b)], map.poses_before[index(its.a)])));
  }
  return sum;
}

double misfit(const Relation& relation, std::span<const Pose> poses) {
  return chi_squared(relation.measurement, ominus(poses[index(relation.b)], poses[index(relation.a)]));
}

// A slip of one kind leaves what was measured otherwise as it is: odometry may be right where a scan was not.
bool agrees(const Relation& relation, std::span<const Pose> poses, const WeakLinkOptions& options) {
  return misfit(relation, poses) < options.common.surprise.bound(3);
}

IslandId island_of(const Contradiction& map) { return map.before.island(map.loop.first.front()); }

constexpr double certain_log_odds = 1e6;  // far beyond what any evidence adds up to

double log_density_of_no_slip(const WeakLinkOptions& options) {
  return log_slip_density(Eigen::Vector3d::Zero(), options);
}

// Log-odds against a link's being off by so much as it would have to if one side of it moved as the loop has
// it, rather than by little: certain where no robot gets so far. Where the move turns the map, that is least
// at the pole of the rotation.
double against_slip(const Contradiction& map, const Relation& link, const WeakLinkOptions& options) {
  const Pose &a = map.poses_before[index(link.a)], &b = map.poses_before[index(link.b)];
  const auto* measured = std::get_if<RelativePose>(&link.measurement);
  const Pose a_from_b = measured ? measured->a_from_b : ominus(b, a);
  const double reach_m = map.reach.between_m(link.a, link.b);
  const auto log_density = [&](const Pose& moved) {
    return std::hypot(moved.x, moved.y) <= reach_m
               ? log_slip_density(wrapped_difference(moved, a_from_b), options)
               : -certain_log_odds;
  };
  const Pose& moves = map.loop.first_from_second;
  return log_density_of_no_slip(options) -
         std::max(log_density(ominus(moves * b, a)), log_density(ominus(b, moves * a)));
}

// The links that are least sure by where they are and by how far they would have to be off. Against the
// closure there is only that another place looks alike just there: nothing for small slips, as what looks
// alike is often near, too.
std::optional<WeakestCut> least_sure(const Contradiction& map, const WeakLinkOptions& options) {
  std::vector<UncertainLink> links = uncertain_links(map.before, island_of(map), map.poses_before, options);
  std::vector<double> slips;
  for (UncertainLink& link : links) {
    slips.push_back(against_slip(map, *map.before.find(link.relation), options));
    link.log_odds += slips.back();
  }
  std::optional<WeakestCut> cut = weakest_cut(links, map.loop.first, map.loop.second);
  if (!cut) return std::nullopt;
  const double look_alike = std::max(0.0, map.log_window + log_density_of_no_slip(options));
  for (std::size_t i = 0; i < links.size(); ++i)
    if (std::ranges::binary_search(cut->relations, links[i].relation))
      links[i].log_odds -= std::min(slips[i], look_alike);
  return weakest_cut(links, map.loop.first, map.loop.second);
}

std::optional<Blame> weakest_link(const Contradiction& map, const WeakLinkOptions& options) {
  std::optional<WeakestCut> link = least_sure(map, options);
  if (!link || link->log_odds > map.max_log_odds) return std::nullopt;
  std::vector<Pose> poses(map.poses_before.begin(), map.poses_before.end());
  for (const PatchId id : link->beyond) poses[index(id)] = map.loop.first_from_second * poses[index(id)];
  RelationGraph without = map.fitted;
  without.remove(link->relations);
  FitReport report = fit_island(without, island_of(map), poses);
  if (!report.ok || map.cost - report.cost_after - cost_of_noise(map, link->relations) < link->log_odds)
    return std::nullopt;
  std::vector<RelationId> wrong = link->relations;
  std::erase_if(wrong, [&](RelationId id) { return agrees(*map.fitted.find(id), poses, options); });
  if (wrong.size() < link->relations.size()) {
    without = map.fitted;
    without.remove(wrong);
    report = fit_island(without, island_of(map), poses);
    if (!report.ok) return std::nullopt;
  }
  const double log_odds = link->log_odds;
  const double cost = report.cost_after + cost_of_noise(map, wrong);
  return Blame{log_odds, *std::move(link), {}, std::move(wrong), cost, std::move(poses)};
}

std::vector<RelationId> resting_on(const RelationGraph& graph, ClosureId closure) {
  const Dependencies dependencies(graph);
  std::vector<RelationId> found;
  for (const auto& [id, relation] : graph.relations())
    if (dependencies.has(id, closure)) found.push_back(id);
  return found;
}

// The way from where the earlier closure bent the map to may be long: the linear solution knows no way.
std::optional<Blame> earlier_closure(const Contradiction& map, const UncertainClosure& earlier) {
  if (earlier.log_odds > std::min(map.max_log_odds, map.max_closure_log_odds)) return std::nullopt;
  std::vector<RelationId> wrong = resting_on(map.before, earlier.id);
  RelationGraph without = map.fitted;
  without.remove(wrong);
  if (wrong.empty() || without.islands().size() != map.fitted.islands().size()) return std::nullopt;
  std::vector<Pose> poses(map.poses_before.begin(), map.poses_before.end());
  const FitReport report = fit_island(without, island_of(map), poses, {.chordal_start = true});
  const double cost = report.cost_after + cost_of_noise(map, wrong);
  if (!report.ok || map.cost - cost < earlier.log_odds) return std::nullopt;
  return Blame{earlier.log_odds, {}, earlier.id, std::move(wrong), cost, std::move(poses)};
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
    const double right = odometry ? options.odometry_log_odds : options.match_log_odds;
    links.push_back({id, std::min(relation.a, relation.b), std::max(relation.a, relation.b),
                     std::max(0.0, right - 0.5 * misfit(relation, poses)), of_placing});
  }
  return links;
}

double Reach::between_m(PatchId a, PatchId b) const {
  if (patches.empty()) return std::numeric_limits<double>::infinity();
  const Patch &one = *patches[index(a)], &other = *patches[index(b)];
  if (one.robot != other.robot) return std::numeric_limits<double>::infinity();
  return slack_m + max_speed_m_per_s * static_cast<double>(std::abs(one.utime - other.utime)) * 1e-6;
}

std::optional<Blame> blame(const Contradiction& contradiction, const WeakLinkOptions& options) {
  Contradiction map = contradiction;
  if (map.loop.first.empty() || map.loop.second.empty()) return std::nullopt;
  const double bent_by = map.cost - cost_of_island(map.before, island_of(map), map.poses_before);
  map.max_log_odds = std::min(map.max_log_odds, bent_by);
  if (map.max_log_odds <= 0) return std::nullopt;
  std::optional<Blame> found = weakest_link(map, options);
  for (const UncertainClosure& earlier : map.loop.closed_before) {
    std::optional<Blame> other = earlier_closure(map, earlier);
    if (other && (!found || other->log_odds + other->cost < found->log_odds + found->cost))
      found = std::move(other);
  }
  return found;
}

}  // namespace isthmus
