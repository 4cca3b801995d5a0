#include <utility>

#include "server/engine/closures/closures.hpp"
#include "server/engine/places/place_candidates.hpp"

namespace isthmus {

ClosureId Closures::propose_from_scans(World world, const ScanProposal& says) {
  const Manifold& manifold = world.map.manifold();
  const RelationGraph& graph = world.map.graph();
  const ClosureId id = note_from_scans(world, says, Reason::on_trial);
  Proposal proposal;
  proposal.id = id;
  proposal.older = graph.island(says.first);
  proposal.younger = graph.island(says.second);
  proposal.merge = proposal.older != proposal.younger;
  proposal.older_from_younger =
      manifold.pose(says.first) * says.first_from_second * inverse(manifold.pose(says.second));
  proposal.relations = says.relations;
  for (Relation& relation : proposal.relations) relation.origin = {OriginKind::hypothesis, id};
  proposal.supporters = says.finds;
  proposal.from_scans = true;
  proposal.cautious = says.cautious;
  proposal.beyond_covariance = systematic_variance(says.way_m);
  begin_trial(world, std::move(proposal));
  return id;
}

ClosureId Closures::note_from_scans(World world, const ScanProposal& says, Reason reason) {
  const ClosureId id = says.id.valid() ? says.id : ClosureId{next_id_++};
  Closure& closure = closures_[id];
  closure.from_scans = true;
  closure.joining = {says.first, says.second, says.first_from_second, Eigen::Matrix3d::Zero()};
  const RelationGraph& graph = world.map.graph();
  ClosureRecord& record = closure.record;
  if (!record.id.valid()) record.start_utime = world.now_utime;
  record.id = id;
  record.kind =
      graph.island(says.first) != graph.island(says.second) ? ClosureKind::merge : ClosureKind::closure;
  record.state = ClosureState::waiting;
  record.reason = reason;
  record.utime = world.map.manifold().patch(says.second).utime;
  record.robots = says.robots;
  record.end_utime = world.now_utime;
  return id;
}

void Closures::refuse_from_scans(ClosureId id, Reason reason) {
  const auto found = closures_.find(id);
  if (found == closures_.end() || found->second.record.state != ClosureState::waiting) return;
  if (trial_ && trial_->proposal().id == id) trial_.reset();
  found->second.record.state = ClosureState::refused;
  found->second.record.reason = reason;
}

void Closures::rule(const Closure& closure, double value) {
  rulings_.push_back({closure.record.id, closure.record.state, closure.record.reason, value});
}

}  // namespace isthmus
