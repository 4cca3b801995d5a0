#pragma once

#include <map>
#include <string>

#include "server/wire/page/map/shown_map.hpp"
#include "server/wire/page/map/trails.hpp"
#include "server/wire/page/tiles/tile_store.hpp"

namespace isthmus {

/// What is sent to viewers, each a line of JSON; the room's README lists the fields. Poses are
/// [island, x, y, yaw] in metres and radians, in the island's frame; angles counter-clockwise.

/// Where each robot is.
std::string robots_text(const Trails& trails, const ShownMap& shown);
/// Where each robot was.
std::string trails_text(const Trails& trails, const ShownMap& shown);
/// Islands with their versions.
std::string islands_text(const ShownMap& shown, const std::map<IslandId, TileStore::Extent>& tiles);
/// Tags that are placed.
std::string tags_text(const ShownMap& shown);
/// Places and zones by name; the last of a place's numbers is its yaw.
std::string annotations_text(const ShownMap& shown);
/// Closures and merges, newest first, a thousand at most.
std::string closures_text(const ShownMap& shown);
/// The last sightings with their verdicts, newest first.
std::string sightings_text(const Trails& trails, const ShownMap& shown);
/// Counts, rates and warnings.
std::string status_text(const ShownMap& shown);
/// The meeting that is asked for, or null.
std::string meeting_text(const ShownMap& shown);

}  // namespace isthmus
