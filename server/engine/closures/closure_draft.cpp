#include "server/engine/closures/closure_draft.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <set>
#include <utility>

#include "server/engine/map/drift.hpp"
#include "server/engine/map/ways.hpp"

namespace isthmus {
namespace {

ClosureDraft draft(Proposal proposal, Joining joining, std::int64_t now_utime) {
  ClosureDraft made{std::move(proposal), {}};
  made.record.joining = std::move(joining);
  made.record.id = made.proposal.id;
  made.record.kind = made.proposal.merge ? ClosureKind::merge : ClosureKind::loop;
  made.record.from_scans = made.proposal.from_scans;
  made.record.start_utime = made.record.end_utime = now_utime;
  return made;
}

Proposal proposal_between(ClosureId id, IslandId a, IslandId b) {
  Proposal proposal;
  proposal.id = id;
  proposal.merge = a != b;
  proposal.older = std::min(a, b);
  proposal.younger = std::max(a, b);
  return proposal;
}

// Of the islands of two patches that lie so to one another.
Proposal proposal_between(const Map& map, ClosureId id, const Joining& joining) {
  const Manifold& manifold = map.manifold();
  const IslandId of_first = map.graph().island(joining.first);
  const IslandId of_second = map.graph().island(joining.second);
  Proposal proposal = proposal_between(id, of_first, of_second);
  const Pose of_first_from_of_second =
      manifold.pose(joining.first) * joining.first_from_second * inverse(manifold.pose(joining.second));
  proposal.older_from_younger =
      of_second < of_first ? inverse(of_first_from_of_second) : of_first_from_of_second;
  return proposal;
}

std::vector<std::string> robots_of(const std::vector<Evidence>& evidence) {
  std::set<std::string> names;
  for (const Evidence& e : evidence) {
    names.insert(e.sighting.robot);
    names.insert(e.target);
  }
  return {names.begin(), names.end()};
}

// Of the ends of relations those that lie on the one side of a loop, and those on the other: nearer to the
// one end of the joining, over the map, than to the other.
OpenLoop open_loop(const Map& map, const Proposal& proposal, const Joining& joining) {
  if (proposal.merge || joining.point) return {};
  const std::vector<double> from_first = ways_over_relations_m(map, std::span(&joining.first, 1));
  const std::vector<double> from_second = ways_over_relations_m(map, std::span(&joining.second, 1));
  std::set<PatchId> first, second;
  for (const Relation& relation : proposal.relations)
    for (const PatchId end : {relation.a, relation.b})
      (from_first[index(end)] < from_second[index(end)] ? first : second).insert(end);
  return {{first.begin(), first.end()},
          {second.begin(), second.end()},
          proposal.older_from_younger,
          from_first[index(joining.second)]};
}

}  // namespace

ClosureDraft draft_of_sightings(const Map& map, ClosureId id, const SightingGroup& group,
                                const GroupAgreement& agreement, const std::vector<Evidence>& supporters,
                                std::int64_t now_utime, const EngineOptions& options) {
  Proposal proposal = proposal_between(id, group.older, group.younger);
  proposal.older_from_younger = agreement.older_from_younger;
  proposal.beyond_covariance = systematic_variance(0, options.place_candidates);
  proposal.supporters = static_cast<int>(supporters.size());
  proposal.two_way = agreement.two_way;
  proposal.prior_log_odds = options.trial.agreed_log_odds;
  for (const Evidence& evidence : supporters)
    if (auto relation = sighting_relation(map, evidence, id, options.alignment, options.evidence))
      proposal.relations.push_back(std::move(*relation));
  proposal.loop = open_loop(map, proposal, agreement.joining);
  ClosureDraft made = draft(std::move(proposal), agreement.joining, now_utime);
  made.record.utime = supporters.front().sighting.utime;
  made.record.robots = robots_of(supporters);
  return made;
}

ClosureDraft draft_of_finds(const Map& map, ClosureId id, const ScanProposal& finds, std::int64_t now_utime,
                            const EngineOptions& options) {
  const Joining joining{finds.first, finds.second, finds.first_from_second, Eigen::Matrix3d::Zero()};
  Proposal proposal = proposal_between(map, id, joining);
  proposal.relations = finds.relations;
  for (Relation& relation : proposal.relations) relation.origin = {OriginKind::hypothesis, id};
  proposal.supporters = finds.finds;
  proposal.from_scans = true;
  proposal.cautious = finds.cautious;
  proposal.look_alikes = finds.look_alikes;
  proposal.prior_log_odds = finds.log_odds;
  if (!proposal.merge) proposal.revisit = {finds.first, finds.second, finds.first_from_second, finds.way_m};
  proposal.beyond_covariance = drift_variance(finds.way_m, options.place_candidates);
  proposal.loop = open_loop(map, proposal, joining);
  ClosureDraft made = draft(std::move(proposal), joining, now_utime);
  made.record.reason = Reason::on_trial;
  made.record.utime = map.manifold().patch(finds.second).utime;
  made.record.robots = finds.robots;
  return made;
}

ClosureDraft draft_of_start(const Map& map, ClosureId id, const Relation& start,
                            std::vector<std::string> robots, std::int64_t now_utime) {
  const auto& [a_from_b, information] = std::get<RelativePose>(start.measurement);
  const Joining joining{start.a, start.b, a_from_b, information.inverse()};
  Proposal proposal = proposal_between(map, id, joining);
  proposal.relations = {start};
  proposal.relations.front().origin.closure = id;
  proposal.measured = true;
  ClosureDraft made = draft(std::move(proposal), joining, now_utime);
  made.record.reason = Reason::measured_start;
  made.record.utime = now_utime;
  made.record.robots = std::move(robots);
  return made;
}

}  // namespace isthmus
