#include "server/engine/closures/taking_back.hpp"

#include <algorithm>
#include <set>

#include "server/engine/closures/withdrawal.hpp"
#include "server/engine/localise/own_ground.hpp"

namespace isthmus {
namespace {

void put_on_own_ground(World world, const Map& together, std::int64_t since_utime, ClosureLedger& ledger,
                       MutualObservations& observations) {
  const OwnGround own(together, world.map);
  const auto put_back_place = [&own](const std::string& robot, PastPlace& place) {
    return own.put_back(robot, place);
  };
  if (world.recorded != nullptr) world.recorded->correct(since_utime, put_back_place);
  for (auto& [name, robot] : world.robots) {
    robot.history.correct([&own, &robot_name = name](PastPlace& place) { own.put_back(robot_name, place); });
    robot.local_loops.clear();  // some may be of patches that lie on two islands now
  }
  const auto put_back = [&](Evidence& evidence) {
    own.put_back(evidence.sighting.robot, evidence.observer);
    if (evidence.target_place && !evidence.is_tag) own.put_back(evidence.target, *evidence.target_place);
  };
  observations.correct(put_back);
  ledger.correct(put_back);
}

// A closure that has fallen with another: as if it had not been proposed yet.
void fall(ClosureLedger::Entry& entry, ClosureLedger& ledger, MutualObservations& observations) {
  if (entry.record.from_scans) return ledger.decide(entry, ClosureState::waiting, Reason::map_changed);
  ledger.decide(entry, ClosureState::withdrawn, Reason::rested_on_another);
  observations.put_back(std::exchange(entry.evidence, {}), Reason::unsupported);
}

// What a closure had taken out of the map as wrong.
void give_back(Map& map, ClosureLedger::Entry& entry) {
  for (const Relation& relation : std::exchange(entry.blamed, {})) map.relate(relation);
}

}  // namespace

std::vector<PatchId> take_back(World world, ClosureId id, ClosureLedger& ledger,
                               MutualObservations& observations, TagPlacer& tags) {
  Joining& joining = ledger.at(id).record.joining;
  joining = as_mapped(world.map, joining);
  const Map together = world.map;
  give_back(world.map, ledger.at(id));
  Withdrawal withdrawal = withdraw(world.map, id, world.robots, world.options);
  tags.displace(world.map, withdrawal.gone, world.options.evidence);
  put_on_own_ground(world, together, ledger.at(id).record.end_utime, ledger, observations);
  for (const ClosureId fallen : withdrawal.fallen) give_back(world.map, ledger.at(fallen));
  for (const ClosureId fallen : withdrawal.fallen) fall(ledger.at(fallen), ledger, observations);
  std::set<IslandId> islands;
  std::set<std::size_t> taken_in;
  for (const Relation& relation : withdrawal.gone) {
    for (const PatchId end : {relation.a, relation.b}) islands.insert(world.map.graph().island(end));
    if (relation.origin.kind == OriginKind::sighting && !relation.origin.closure.valid())
      taken_in.insert(static_cast<std::size_t>(relation.origin.sighting));
  }
  observations.reopen(world, tags.patches(), std::vector(taken_in.begin(), taken_in.end()));
  observations.forget_lone_refits(world.map.graph());
  return {islands.begin(), islands.end()};
}

}  // namespace isthmus
