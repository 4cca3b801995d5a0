#include "server/engine/withdrawal.hpp"

#include <cmath>
#include <vector>

namespace isthmus {
namespace {

constexpr double consistent_m = 0.5;
constexpr double consistent_rad = 0.3;

// Whether the fitted poses are about where the relation alone would have them.
bool consistent(const Map& map, const Relation& relation) {
  const Pose fitted = ominus(map.manifold().pose(relation.b), map.manifold().pose(relation.a));
  const Pose off = ominus(minimiser(relation.measurement, fitted), fitted);
  return std::hypot(off.x, off.y) < consistent_m && std::abs(off.yaw) < consistent_rad;
}

void put_back(const Map& map, Robot& robot) {
  if (!robot.place) return;
  Localisation& place = *robot.place;
  if (map.graph().island(place.pose.patch) == map.graph().island(place.last_patch)) return;
  place.pose = {place.last_patch, place.since_last_patch.start_from_end};
  place.covariance = place.spread = place.since_last_patch.covariance;
}

}  // namespace

void withdraw(Map& map, ClosureId closure, std::map<std::string, Robot>& robots) {
  std::vector<RelationId> gone;
  std::vector<Relation> doubtful;
  for (const auto& [id, relation] : map.graph().relations()) {
    const bool own = relation.origin.closure == closure;
    const bool made_since = !gone.empty() && relation.origin.kind == OriginKind::match;
    if (!own && !made_since) continue;
    gone.push_back(id);
    if (!own) doubtful.push_back(relation);
  }
  if (gone.empty()) return;
  const PatchId a = map.graph().find(gone.front())->a;
  const PatchId b = map.graph().find(gone.front())->b;
  map.remove(gone);
  const auto refit = [&] {
    map.refit_island(map.graph().island(a));
    if (map.graph().island(a) != map.graph().island(b)) map.refit_island(map.graph().island(b));
  };
  refit();
  for (const Relation& relation : doubtful) {
    if (map.graph().island(relation.a) == map.graph().island(relation.b) && consistent(map, relation))
      map.relate(relation);
  }
  refit();
  for (auto& [name, robot] : robots) put_back(map, robot);
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
