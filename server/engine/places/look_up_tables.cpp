#include "server/engine/places/look_up_tables.hpp"

namespace isthmus {

const WayNetwork& LookUpTables::network(const Map& map) {
  if (!network_) network_.emplace(map);
  return *network_;
}

const IslandCovariances& LookUpTables::covariances(const Map& map, IslandId island) {
  return covariances_.try_emplace(island, map.graph(), map.manifold().poses(), island).first->second;
}

std::shared_ptr<LookUpTables> KeptTables::of(const Map& map) {
  if (!tables_ || changes_ != map.changes()) tables_ = std::make_shared<LookUpTables>();
  changes_ = map.changes();
  return tables_;
}

}  // namespace isthmus
