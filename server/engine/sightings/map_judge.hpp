#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include "server/engine/input/engine_options.hpp"
#include "server/engine/sightings/evidence.hpp"

namespace isthmus {

/// What the map says of a sighting between two of its patches.
enum class Judgement {
  unknown,      ///< they are on two islands, or the map does not know it well enough
  contradicts,  ///< it knows that the target is elsewhere
  agrees,
  teaches,  ///< agrees, and says more than the map knows: it is worth a relation
};

/// Judges sightings by the map: where it knows well how observer and target lie, it decides alone whether
/// the sighting is possible.
class MapJudge {
 public:
  /// The sighting's target must have a place.
  Judgement judge(const Map& map, const Evidence& evidence, const EngineOptions& options);

  auto members() { return std::tie(weighed_utime_); }

 private:
  /// When a sighting of that target by that observer was last weighed against the map's own confidence.
  std::map<std::pair<std::string, std::string>, std::int64_t> weighed_utime_;
};

}  // namespace isthmus
