#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "relations/graph.hpp"

namespace isthmus {

/// Patches at most so many relations apart are near one another, whatever else holds the map together.
inline constexpr int known_near_hops = 4;

/// Whether a relation may carry what another says: only matches and odometry say where walls are.
bool carries(const Relation& link, const Relation& what);

/// Whether the ends of a relation are known to be near without it, by what else is in the graph.
bool known_near(const RelationGraph& graph, const Relation& relation);

/// The closures that each relation of a map depends on. A relation of a closure depends on that closure. Any
/// other was made because the map had its two ends near one another: where they are so by relations made
/// before it that depend on nothing, so does it; else it depends on what the shortest way between them, as it
/// was when the relation was made, depends on. (Relations are never changed, and their ids count up: what was
/// there before is what has a lower id.) Odometry and measured starts are what robots and operators say, and
/// need no map.
///
/// Where two closures join the same patches, that is the one by which the map knew: a relation that depends
/// on a closure need not fall with it (withdrawal.hpp).
class Dependencies {
 public:
  explicit Dependencies(const RelationGraph& graph);

  /// By id, each once; empty for most relations.
  std::span<const ClosureId> of(RelationId id) const;
  bool has(RelationId id, ClosureId closure) const;

 private:
  std::vector<std::vector<ClosureId>> sets_;  ///< each once; the empty one is the first
  std::vector<std::uint32_t> set_of_;         ///< by relation id
};

/// A graph but for what depends on a closure.
RelationGraph without(const RelationGraph& graph, const Dependencies& dependencies, ClosureId closure);

/// The closures by which a map knows how two of its patches lie to one another: those on which the shortest
/// way between them depends. By id; none where they are not connected. Whatever closure's end would part the
/// two is among them.
std::vector<ClosureId> closures_between(const RelationGraph& graph, PatchId a, PatchId b);
std::vector<ClosureId> closures_between(const RelationGraph& graph, const Dependencies& dependencies,
                                        PatchId a, PatchId b);

}  // namespace isthmus
