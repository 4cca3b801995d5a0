#include "server/engine/map/map.hpp"

#include <algorithm>
#include <utility>

#include "relations/fit.hpp"

namespace isthmus {

void Map::add(PatchPtr patch, const Pose& map_from_patch) {
  const PatchId id = patch->id;
  graph_.add_patch(id);
  manifold_.add(std::move(patch), map_from_patch);
  stamps_.push_back(0);
  touch(id);
}

RelationId Map::relate(const Relation& relation) {
  touch(relation.a);
  touch(relation.b);
  return graph_.add(relation);
}

void Map::remove(std::span<const RelationId> relations) {
  for (const RelationId id : relations) {
    const Relation* relation = graph_.find(id);
    if (!relation) continue;
    touch(relation->a);
    touch(relation->b);
  }
  graph_.remove(relations);
}

void Map::move_island(IslandId island, const Pose& new_from_old) {
  for (const PatchId id : graph_.patches_of(island)) {
    manifold_.set_pose(id, new_from_old * manifold_.pose(id));
    touch(id);
  }
}

void Map::adopt(std::span<const PatchId> of, std::span<const Pose> poses) {
  const std::vector<Pose> before(manifold_.poses().begin(), manifold_.poses().end());
  std::vector<bool> settled(before.size(), false);
  const auto settle = [&](PatchId id, const Pose& pose) {
    manifold_.set_pose(id, pose);
    settled[static_cast<std::size_t>(id.value)] = true;
    touch(id);
  };
  for (const PatchId id : of) settle(id, poses[static_cast<std::size_t>(id.value)]);
  for (std::size_t i = poses.size(); i < before.size(); ++i) {
    const PatchId id{static_cast<std::int32_t>(i)};
    for (const PatchId other : graph_.neighbours(id)) {
      if (!settled[static_cast<std::size_t>(other.value)]) continue;
      settle(id, manifold_.pose(other) * ominus(before[i], before[static_cast<std::size_t>(other.value)]));
      break;
    }
  }
}

void Map::refit_around(PatchId centre, std::size_t max_patches) {
  std::vector<PatchId> window = graph_.nearest_in_graph(centre, max_patches);
  std::erase(window, graph_.island(centre));
  if (!window.empty() && fit(graph_, window, manifold_.poses()).ok)
    std::for_each(window.begin(), window.end(), [this](PatchId id) { touch(id); });
}

void Map::refit_island(IslandId island) {
  if (!fit_island(graph_, island, manifold_.poses()).ok) return;
  for (const PatchId id : graph_.patches_of(island)) touch(id);
}

std::int64_t Map::stamp(std::span<const PatchId> patches) const {
  std::int64_t newest = 0;
  for (const PatchId id : patches) newest = std::max(newest, stamps_[static_cast<std::size_t>(id.value)]);
  return newest;
}

bool Map::is_sound() const {
  const std::size_t size = manifold_.patches().size();
  return manifold_.poses().size() == size && graph_.patch_count() == size && stamps_.size() == size;
}

void Map::touch(PatchId patch) { stamps_[static_cast<std::size_t>(patch.value)] = ++changes_; }

}  // namespace isthmus
