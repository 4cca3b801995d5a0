#include "server/wire/page/map/preview.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "server/engine/map/dependencies.hpp"

namespace isthmus {
namespace {

using Json = nlohmann::json;

/// What hangs on a closure.
struct Resting {
  std::vector<RelationId> own;
  std::vector<RelationId> dependent;  ///< others
};

Resting resting_on(const RelationGraph& graph, ClosureId closure) {
  const Dependencies dependencies(graph);
  Resting resting;
  for (const auto& [id, relation] : graph.relations()) {
    if (relation.origin.closure == closure) {
      resting.own.push_back(id);
    } else if (dependencies.has(id, closure)) {
      resting.dependent.push_back(id);
    }
  }
  return resting;
}

/// How many patches each part of some islands has once relations are gone, most first.
std::vector<std::size_t> parts(RelationGraph graph, const std::set<IslandId>& islands,
                               const std::vector<RelationId>& gone) {
  std::set<PatchId> patches;
  for (const IslandId island : islands) {
    const std::vector<PatchId> of = graph.patches_of(island);
    patches.insert(of.begin(), of.end());
  }
  graph.remove(gone);
  std::vector<std::size_t> sizes;
  for (const std::vector<PatchId>& island : graph.islands())
    if (patches.contains(island.front())) sizes.push_back(island.size());
  std::ranges::sort(sizes, std::greater<>());
  return sizes;
}

Json sightings_json(const SightingLog& log, ClosureId closure) {
  std::map<std::string, int> counts;
  for (const SightingRecord& record : log)
    if (record.closure == closure) counts[std::string(word(record.verdict))] += 1;
  return counts;
}

/// How many closures of each kind there are among some.
Json kinds_json(const MapCopy& map, const std::set<ClosureId>& closures) {
  std::map<std::string, int> counts;
  for (const ClosureRecord& closure : map.closures)
    if (closures.contains(closure.id)) counts[std::string(word(closure.kind))] += 1;
  return counts;
}

}  // namespace

std::string closure_preview(const ShownMap& shown, ClosureId closure) {
  const MapCopy& map = shown.map();
  const auto found = std::ranges::find(map.closures, closure, &ClosureRecord::id);
  if (found == map.closures.end()) return "";
  const Resting resting = resting_on(map.graph, closure);
  std::map<std::string, int> origins;
  std::set<IslandId> islands;
  for (const RelationId id : resting.own) {
    const Relation& relation = *map.graph.find(id);
    origins[std::string(name(relation.origin.kind))] += 1;
    islands.insert(shown.island(relation.a));
  }
  std::vector<RelationId> all = resting.own;
  all.insert(all.end(), resting.dependent.begin(), resting.dependent.end());
  return Json{{"closure", closure.value},
              {"kind", std::string(word(found->kind))},
              {"state", std::string(word(found->state))},
              {"relations", origins},
              {"sightings", sightings_json(map.sightings, closure)},
              {"dependent", resting.dependent.size()},
              {"parts", parts(map.graph, islands, resting.own)},
              {"parts_at_most", parts(map.graph, islands, all)}}
      .dump();
}

std::string robot_preview(const ShownMap& shown, const std::string& robot) {
  const MapCopy& map = shown.map();
  std::set<RelationId> relations;
  std::set<ClosureId> closures;
  std::size_t patches = 0, left_out = 0;
  for (const PatchPtr& patch : map.patches) {
    if (patch->robot != robot || patch->tag >= 0) continue;
    (is_left_out(map, patch->id) ? left_out : patches) += 1;
    const auto of = map.graph.of(patch->id);
    relations.insert(of.begin(), of.end());
  }
  for (const RelationId id : relations) closures.insert(map.graph.find(id)->origin.closure);
  return Json{{"robot", robot},
              {"patches", patches},
              {"left_out", left_out},
              {"relations", relations.size()},
              {"closures", kinds_json(map, closures)}}
      .dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace isthmus
