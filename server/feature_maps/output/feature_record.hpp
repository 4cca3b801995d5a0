#pragma once

#include "server/engine/record/map_copy.hpp"
#include "server/feature_maps/mapper/feature_mapper.hpp"

namespace isthmus {

/// What status, metrics and logs tell of maps of features, as they tell it of the manifold map: sightings
/// with their verdicts, fusions as merges, counters. There are no patches, so no relations, sessions and
/// grids. Of `summary` sightings are not looked at: a log shares them with the map, and is copied at a
/// pointer for many.
MapCopy record_of(const FeatureMaps& summary, const SightingLog& sightings);

SightingRecord record_of(const FeatureSighting& sighting);

}  // namespace isthmus
