#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>

#include "relations/confidence.hpp"
#include "server/engine/map/map.hpp"
#include "server/engine/map/ways.hpp"

namespace isthmus {

/// What is reckoned once of a map, whatever places are looked up on it; each part when it is first asked for.
/// For one thread at a time.
class LookUpTables {
 public:
  const WayNetwork& network(const Map& map);
  const IslandCovariances& covariances(const Map& map, IslandId island);

 private:
  std::optional<WayNetwork> network_;
  std::map<IslandId, IslandCovariances> covariances_;
};

/// The tables of a map for as long as it stays as it is. No part of the engine's state: they can be reckoned
/// anew.
class KeptTables {
 public:
  /// Those of the map as it is now.
  std::shared_ptr<LookUpTables> of(const Map& map);

  /// A snapshot has nothing of them.
  template <class Archive>
  void save(Archive& /*archive*/) const {}
  template <class Archive>
  void load(Archive& /*archive*/) {
    tables_ = nullptr;
  }

 private:
  std::shared_ptr<LookUpTables> tables_;
  std::int64_t changes_ = 0;
};

}  // namespace isthmus
