#include "server/engine/closures/withdrawal.hpp"

#include <utility>

#include "server/engine/closures/rejudging.hpp"

namespace isthmus {
namespace {

bool is_evidence(const Origin& origin) {
  return origin.closure.valid() && origin.kind != OriginKind::propagation;
}

void put_back(const Map& map, Robot& robot) {
  if (!robot.place) return;
  Localisation& place = *robot.place;
  if (map.graph().island(place.pose.patch) == map.graph().island(place.last_patch)) return;
  place.pose = {place.last_patch, place.since_last_patch.start_from_end};
  place.covariance = place.tracking_covariance = place.since_last_patch.covariance;
}

void take_over(Map& map, const Rejudging& judged) {
  std::vector<RelationId> gone;
  for (const Relation& relation : judged.gone()) gone.push_back(relation.id);
  map.remove(gone);
  for (const IslandId island : judged.changed()) {
    map.adopt(judged.rest().graph().patches_of(island), judged.rest().manifold().poses());
    map.refit_island(island);
  }
}

}  // namespace

Withdrawal withdraw(Map& map, ClosureId closure, std::map<std::string, Robot>& robots,
                    const EngineOptions& options) {
  const Dependencies dependencies(map.graph());
  std::set<ClosureId> without{closure};
  while (true) {
    const Rejudging judged(map, dependencies, without, options);
    const std::size_t known = without.size();
    for (const Relation& relation : judged.gone())
      if (is_evidence(relation.origin)) without.insert(relation.origin.closure);
    if (without.size() > known) continue;
    take_over(map, judged);
    for (auto& [name, robot] : robots) put_back(map, robot);
    without.erase(closure);
    return {judged.gone(), without};
  }
}

std::vector<Relation> take_out(Map& map, const std::string& robot, std::map<std::string, Robot>& robots) {
  const auto is_its = [&](PatchId id) { return map.manifold().patch(id).robot == robot; };
  std::vector<RelationId> gone;
  std::vector<Relation> taken;
  for (const auto& [id, relation] : map.graph().relations()) {
    if (!is_its(relation.a) && !is_its(relation.b)) continue;
    gone.push_back(id);
    taken.push_back(relation);
  }
  map.remove(gone);
  for (auto& [name, other] : robots) {
    if (name != robot) put_back(map, other);
  }
  return taken;
}

}  // namespace isthmus
