#pragma once

#include <string_view>

#include "server/wire/page/http/http_answer.hpp"
#include "server/wire/page/map/packed_patches.hpp"
#include "server/wire/page/map/shown_map.hpp"
#include "server/wire/page/tiles/tile_store.hpp"

namespace isthmus {

/// A map as requests see it.
struct MapOnPage {
  const ShownMap* shown;  ///< none: no map yet
  TileStore& tiles;
  PackedPatches& packed;
};

/// Answers what asks for a map's tiles or patches, and refuses what there is not; false: `path` asks for
/// something else.
bool get_of_map(const MapOnPage& map, std::string_view path, const httplib::Request& request,
                httplib::Response& response);

}  // namespace isthmus
