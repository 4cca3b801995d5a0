#pragma once

#include <span>
#include <tuple>
#include <vector>

#include "patches/manifold.hpp"
#include "relations/graph.hpp"

namespace isthmus {

/// The manifold map: patches with their projected poses, and the relations between them. Every change goes
/// through here and leaves a stamp on the patches it touches, by which those who keep something derived from
/// them know when to look again.
class Map {
 public:
  const Manifold& manifold() const { return manifold_; }
  const RelationGraph& graph() const { return graph_; }

  /// a_from_b of two patches of one island, as they are mapped now.
  Pose relative_pose(PatchId a, PatchId b) const { return manifold_.relative_pose(a, b); }

  void add(PatchPtr patch, const Pose& map_from_patch);
  RelationId relate(const Relation& relation);
  /// Takes relations away. Islands part where nothing else joins them; poses stay.
  void remove(std::span<const RelationId> relations);

  /// Moves an island rigidly in its plane, or into another's.
  void move_island(IslandId island, const Pose& new_from_old);
  /// Takes over the poses that a fit of a copy of this map found, for those of its patches that were among
  /// `of` then. Patches made since keep their place relative to one of those that they are related to.
  void adopt(std::span<const PatchId> of, std::span<const Pose> poses);

  /// Refits the patches nearest in the graph to one, at most so many, their surroundings held. The island's
  /// oldest patch carries its frame and is held too.
  void refit_around(PatchId centre, std::size_t max_patches);
  void refit_island(IslandId island);

  /// How often it was changed: two answers that are the same are of the same map.
  std::int64_t changes() const { return changes_; }
  /// The newest stamp on any of these patches.
  std::int64_t stamp(std::span<const PatchId> patches) const;

  /// Whether its parts agree on the patches: checks a map that was read from a file.
  bool is_sound() const;

  auto members() { return std::tie(manifold_, graph_, stamps_, changes_); }

 private:
  void touch(PatchId patch);

  Manifold manifold_;
  RelationGraph graph_;
  std::vector<std::int64_t> stamps_;  // by patch id
  std::int64_t changes_ = 0;
};

}  // namespace isthmus
