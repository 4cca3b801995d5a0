#include "server/paths/ground/scan_parts.hpp"

#include "relations/disjoint_sets.hpp"
#include "server/engine/map/surroundings.hpp"

namespace isthmus {

std::vector<PatchId> scan_parts(const MapCopy& map) {
  std::vector<PatchId> parts;
  for (std::size_t i = 0; i < map.patches.size(); ++i) parts.push_back(PatchId{static_cast<std::int32_t>(i)});
  DisjointSets<PatchId> sets(parts);
  for (const auto& [id, relation] : map.graph.relations())
    if (says_where_walls_are(relation)) sets.join(relation.a, relation.b);
  for (PatchId& part : parts) part = sets.lowest(part);
  return parts;
}

}  // namespace isthmus
