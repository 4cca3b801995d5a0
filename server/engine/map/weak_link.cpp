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

// That all are right, of two log-odds: what is wrong is the one or the other.
double log_odds_of_both(double one, double other) {
  const double less = std::min(one, other);
  return less - std::log1p(std::exp(less - std::max(one, other)));
}

/// The links that may have been off by so much as the loop has it.
class Suspects {
 public:
  Suspects(const Contradiction& map, const WeakLinkOptions& options)
      : map_(map),
        links_(uncertain_links(map.before, island_of(map), map.poses_before, options)),
        look_alike_(std::max(0.0, map.log_window + log_density_of_no_slip(options))) {
    for (UncertainLink& link : links_) {
      slips_.push_back(against_slip(map, *map.before.find(link.relation), options));
      link.log_odds += slips_.back();
    }
  }

  /// Those that are least sure by where they are and by how far they would have to be off. Against the
  /// closure there is only that another place looks alike just there: nothing for small slips, as what looks
  /// alike is often near, too.
  std::optional<WeakestCut> least_sure() const {
    const std::optional<WeakestCut> cut = weakest_cut(links_, map_.loop.first, map_.loop.second);
    if (!cut || cut->log_odds >= certain_log_odds) return std::nullopt;
    std::vector<UncertainLink> links = links_;
    for (std::size_t i = 0; i < links.size(); ++i)
      if (std::ranges::binary_search(cut->relations, links[i].relation))
        links[i].log_odds -= std::min(slips_[i], look_alike_);
    return weakest_cut(links, map_.loop.first, map_.loop.second);
  }

  /// A step of a robot's way is not to blame, whatever else spans it; where no robot made it, none of them.
  void acquit(const WeakestCut& step) {
    std::vector<UncertainLink*> its_links, driven;
    for (UncertainLink& link : links_) {
      if (!std::ranges::binary_search(step.relations, link.relation)) continue;
      its_links.push_back(&link);
      if (map_.before.find(link.relation)->origin.kind == OriginKind::odometry) driven.push_back(&link);
    }
    for (UncertainLink* link : driven.empty() ? its_links : driven) link->log_odds = certain_log_odds;
  }

 private:
  const Contradiction& map_;
  std::vector<UncertainLink> links_;
  std::vector<double> slips_;
  double look_alike_;
};

// Which of the steps of a way is wrong is not known before: the log-odds that none is, by each one's own. Few
// of hundreds could be off by so much.
double log_odds_that_none_is_wrong(Suspects suspects, WeakestCut link) {
  constexpr int max_suspects = 100;
  constexpr double negligible = 5;  // log-odds beyond those of all before it: adds less than 1 %
  double all_right = link.log_odds;
  for (int i = 1; i < max_suspects; ++i) {
    suspects.acquit(link);
    std::optional<WeakestCut> next = suspects.least_sure();
    if (!next || next->log_odds > all_right + negligible) break;
    all_right = log_odds_of_both(all_right, next->log_odds);
    link = *std::move(next);
  }
  return all_right;
}

std::optional<Blame> weakest_link(const Contradiction& map, double bent_by, const WeakLinkOptions& options) {
  const Suspects suspects(map, options);
  std::optional<WeakestCut> link = suspects.least_sure();
  if (!link || link->log_odds > bent_by) return std::nullopt;
  const double none_log_odds = log_odds_that_none_is_wrong(suspects, *link);
  if (none_log_odds > map.max_log_odds) return std::nullopt;
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
  return Blame{log_odds, none_log_odds, *std::move(link), {}, std::move(wrong), cost, std::move(poses)};
}

std::vector<RelationId> resting_on(const RelationGraph& graph, ClosureId closure) {
  const Dependencies dependencies(graph);
  std::vector<RelationId> found;
  for (const auto& [id, relation] : graph.relations())
    if (dependencies.has(id, closure)) found.push_back(id);
  return found;
}

// The way from where the earlier closure bent the map to may be long: the linear solution knows no way.
std::optional<Blame> earlier_closure(const Contradiction& map, const UncertainClosure& earlier,
                                     double none_log_odds) {
  std::vector<RelationId> wrong = resting_on(map.before, earlier.id);
  RelationGraph without = map.fitted;
  without.remove(wrong);
  if (wrong.empty() || without.islands().size() != map.fitted.islands().size()) return std::nullopt;
  std::vector<Pose> poses(map.poses_before.begin(), map.poses_before.end());
  const FitReport report = fit_island(without, island_of(map), poses, {.chordal_start = true});
  const double cost = report.cost_after + cost_of_noise(map, wrong);
  if (!report.ok || map.cost - cost < earlier.log_odds) return std::nullopt;
  return Blame{earlier.log_odds, none_log_odds, {}, earlier.id, std::move(wrong), cost, std::move(poses)};
}

double log_odds_that_none_is_wrong(std::span<const UncertainClosure> closures) {
  double all_right = std::numeric_limits<double>::infinity();
  for (const UncertainClosure& closure : closures) all_right = log_odds_of_both(all_right, closure.log_odds);
  return all_right;
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

std::optional<Blame> blame(const Contradiction& map, const WeakLinkOptions& options) {
  if (map.loop.first.empty() || map.loop.second.empty()) return std::nullopt;
  const double bent_by = map.cost - cost_of_island(map.before, island_of(map), map.poses_before);
  if (bent_by <= 0 || map.max_log_odds <= 0) return std::nullopt;
  std::optional<Blame> found = weakest_link(map, bent_by, options);
  const double none_log_odds = log_odds_that_none_is_wrong(map.loop.closed_before);
  if (none_log_odds > map.max_log_odds) return found;
  for (const UncertainClosure& earlier : map.loop.closed_before) {
    if (earlier.log_odds > bent_by) continue;
    std::optional<Blame> other = earlier_closure(map, earlier, none_log_odds);
    if (other && (!found || other->log_odds + other->cost < found->log_odds + found->cost))
      found = std::move(other);
  }
  return found;
}

}  // namespace isthmus
