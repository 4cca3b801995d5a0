#pragma once

#include <functional>
#include <string>

#include "server/engine/record/map_copy.hpp"
#include "server/output/tables/islands.hpp"

namespace isthmus {

/// Places and zones as GeoJSON (RFC 7946, but in the plane of each one's island, in metres): a feature each,
/// a place a Point, a zone a Polygon. Properties: `kind`, `name`, `island` (by its number; -1: none),
/// `yaw_rad` of a place, `max_speed_m_s` of a speed zone, `lost`, and `points`: [patch, x, y] of each, in
/// that patch's frame. A lost one has no geometry.
std::string annotations_geojson(const MapCopy& map, const std::function<int(IslandId)>& number_of);
/// Islands by rank, as in all files of a result.
std::string annotations_geojson(const MapCopy& map, const RankedIslands& islands);

/// Writes them to a file; where there are none, a file of an earlier result is removed.
void write_annotations(const MapCopy& map, const RankedIslands& islands, const std::string& path);

}  // namespace isthmus
