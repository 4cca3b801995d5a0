#include "server/output/foxglove/map_content.hpp"

#include <cmath>
#include <map>
#include <set>

namespace isthmus::foxglove {
namespace {

constexpr double island_gap_m = 2;
constexpr double island_step_m = 10;

Eigen::Vector2d place_of(const MapCopy& map, PatchId id) {
  return position(map.poses[static_cast<std::size_t>(id.value)]);
}

/// The scene that a patch belongs to.
class SceneOf {
 public:
  SceneOf(const std::vector<Island>& islands, std::vector<Scene>& scenes) {
    for (std::size_t i = 0; i < islands.size(); ++i)
      for (const PatchId id : islands[i].patches) scenes_[id] = &scenes[i];
  }
  /// None where it is on none of the islands.
  Scene* find(PatchId id) const {
    const auto found = scenes_.find(id);
    return found == scenes_.end() ? nullptr : found->second;
  }

 private:
  std::map<PatchId, Scene*> scenes_;
};

}  // namespace

std::string island_frame(int number) { return "island-" + std::to_string(number); }

std::vector<Transform> side_by_side(const MapCopy& map, const std::vector<Island>& islands) {
  std::vector<Transform> transforms;
  double next_left_m = 0;
  for (const Island& island : islands) {
    const MapBox box = island_box(map, island.patches);
    const double x_m =
        transforms.empty() ? 0 : std::ceil((next_left_m - box.low.x()) / island_step_m) * island_step_m;
    transforms.push_back({"map", island.frame, {x_m, 0, 0}});
    next_left_m = x_m + box.high.x() + island_gap_m;
  }
  return transforms;
}

std::vector<Scene> scenes(const MapCopy& map, const std::vector<Island>& islands) {
  std::vector<Scene> all;
  for (const Island& island : islands) {
    Scene scene;
    scene.frame = island.frame;
    for (const PatchId id : island.patches) scene.patches.push_back({place_of(map, id), ""});
    all.push_back(std::move(scene));
  }
  const SceneOf scene_of(islands, all);
  const RankedIslands ranks = rank_islands(map);
  for (const TagRecord& tag : map.tags) {
    const int rank = ranks.rank(tag.patch);
    if (rank < 0) continue;
    if (Scene* scene = scene_of.find(ranks.patches[static_cast<std::size_t>(rank)].front()))
      scene->tags.push_back({tag.position, std::to_string(tag.barcode)});
  }
  std::set<ClosureId> shown;
  for (const auto& [id, relation] : map.graph.relations()) {
    Scene* scene = scene_of.find(relation.a);
    if (!scene || !relation.origin.closure.valid() || !shown.insert(relation.origin.closure).second) continue;
    scene->closures.push_back({place_of(map, relation.a), place_of(map, relation.b)});
  }
  return all;
}

std::string closure_text(const ClosureRecord& closure) {
  std::string text = std::string(word(closure.kind)) + ' ' + std::to_string(closure.id.value) + ' ' +
                     std::string(word(closure.state));
  if (closure.reason != Reason::none) text += " (" + std::string(word(closure.reason)) + ')';
  for (std::size_t i = 0; i < closure.robots.size(); ++i) text += (i == 0 ? ": " : ", ") + closure.robots[i];
  return text;
}

Level closure_level(const ClosureRecord& closure) {
  return closure.state == ClosureState::refused || closure.state == ClosureState::withdrawn ? Level::warning
                                                                                            : Level::info;
}

}  // namespace isthmus::foxglove
