#include <algorithm>
#include <cmath>
#include <iterator>

#include "server/engine/closures/closures.hpp"
#include "server/engine/closures/withdrawal.hpp"
#include "server/engine/localise/own_ground.hpp"

namespace isthmus {
namespace {

// Whether the sightings of a tag that are left would have placed it.
bool is_still_placed(const Map& map, const std::vector<Relation>& left) {
  PointConsensus consensus;
  consensus.supporters.resize(left.size());
  for (const Relation& relation : left) {
    const Pose apart = ominus(map.manifold().pose(relation.a), map.manifold().pose(left.front().a));
    consensus.apart_m = std::max(consensus.apart_m, std::hypot(apart.x, apart.y));
  }
  return consensus.enough();
}

std::vector<Relation> relations_of(const RelationGraph& graph, PatchId patch) {
  std::vector<Relation> relations;
  for (const RelationId id : graph.of(patch)) relations.push_back(*graph.find(id));
  return relations;
}

}  // namespace

// An accepted closure out of the map, with all that depends on it.
void Closures::take_back(World world, Closure& closure) {
  closure.joining = as_mapped(world.map, closure.joining);
  const Map together = world.map;
  Withdrawal withdrawal = withdraw(world.map, closure.record.id, world.robots, world.options);
  unplace_tags(world, withdrawal.gone);
  put_on_own_ground(world, together);
  for (const ClosureId id : withdrawal.fallen) fall(id);
  std::set<IslandId> islands;
  for (const Relation& relation : withdrawal.gone) {
    for (const PatchId end : {relation.a, relation.b}) islands.insert(world.map.graph().island(end));
    if (relation.origin.kind == OriginKind::sighting && !relation.origin.closure.valid())
      reopen(world, static_cast<std::size_t>(relation.origin.sighting));
  }
  std::ranges::stable_sort(pool_, {}, &Evidence::record);
  changed_.insert(changed_.end(), islands.begin(), islands.end());
  std::erase_if(to_refit_, [&](PatchId patch) { return world.map.graph().of(patch).empty(); });
}

// Tags that too little is left of are nowhere again; `gone` takes what was left.
void Closures::unplace_tags(World world, std::vector<Relation>& gone) {
  std::set<PatchId> touched;
  for (const Relation& relation : gone) touched.insert({relation.a, relation.b});
  for (auto tag = tag_patches_.begin(); tag != tag_patches_.end();) {
    const std::vector<Relation> left = relations_of(world.map.graph(), tag->second);
    const bool of_closures =
        std::ranges::any_of(left, [](const Relation& relation) { return relation.origin.closure.valid(); });
    if (!touched.contains(tag->second) || of_closures || is_still_placed(world.map, left)) {
      ++tag;
      continue;
    }
    std::vector<RelationId> ids;
    for (const Relation& relation : left) ids.push_back(relation.id);
    world.map.remove(ids);
    std::ranges::copy(left, std::back_inserter(gone));
    tag = tag_patches_.erase(tag);
  }
}

void Closures::put_on_own_ground(World world, const Map& together) {
  const OwnGround own(together, world.map);
  for (auto& [name, robot] : world.robots) {
    robot.history.correct([&](PastPlace& place) { own.put_back(name, place); });
    robot.rejoins.clear();  // some may be of patches that lie on two islands now
  }
  const auto put_back = [&](Evidence& evidence) {
    own.put_back(evidence.sighting.robot, evidence.observer);
    if (evidence.target_place && !evidence.is_tag) own.put_back(evidence.target, *evidence.target_place);
  };
  std::ranges::for_each(pool_, put_back);
  for (auto& [id, closure] : closures_) std::ranges::for_each(closure.evidence, put_back);
}

// A closure that has fallen with another: as if it had not been proposed yet.
void Closures::fall(ClosureId id) {
  Closure& closure = closures_.at(id);
  if (closure.from_scans) {
    closure.record.state = ClosureState::waiting;
    closure.record.reason = Reason::map_changed;
    return rule(closure);
  }
  closure.record.state = ClosureState::withdrawn;
  closure.record.reason = Reason::rested_on_another;
  return_to_pool(closure.evidence, Reason::unsupported);
}

// A sighting that the map had taken in waits again, where it is still known from where it was made.
void Closures::reopen(World world, std::size_t record) {
  Evidence evidence;
  evidence.record = record;
  evidence.sighting = records_[record].sighting;
  evidence.receive_utime = world.now_utime;
  const auto worn = std::ranges::find_if(world.robots, [&](const auto& entry) {
    return entry.second.declared && entry.second.declaration.barcode == evidence.sighting.barcode;
  });
  evidence.is_tag = worn == world.robots.end();
  evidence.target = evidence.is_tag ? tag_name(evidence.sighting.barcode) : worn->first;
  const Placing placing = place_on_manifold(world.robots, tag_patches_, true, evidence);
  if (placing.state != Placing::State::placed) return verdict(evidence, Verdict::refused, placing.reason);
  verdict(evidence, Verdict::waiting, evidence.doubt);
  pool_.push_back(std::move(evidence));
}

void Closures::return_to_pool(std::vector<Evidence>& evidence, Reason doubt) {
  for (Evidence& one : evidence) {
    one.doubt = doubt;
    verdict(one, Verdict::waiting, doubt);
    pool_.push_back(std::move(one));
  }
  evidence.clear();
  std::ranges::stable_sort(pool_, {}, &Evidence::record);
}

// What a trial was begun on will no longer be.
void Closures::put_off_trial() {
  if (!trial_) return;
  Closure& closure = closures_.at(trial_->proposal().id);
  trial_.reset();
  if (closure.from_scans) return put_off(closure.record.id);
  closure.record.state = ClosureState::refused;
  closure.record.reason = Reason::map_changed;
  return_to_pool(closure.evidence, Reason::unsupported);
}

}  // namespace isthmus
