#pragma once

#include <string>

#include "server/engine/record/map_copy.hpp"

namespace isthmus {

/// Writes DIRECTORY/vda5050-maps.json: for each island's grid there, what a fleet's control tells a robot by
/// the action `downloadMap` of VDA 5050 (3.0). `mapId` is "NAME-I", I being the lowest patch id on the
/// island; `mapVersion` the first 16 digits of map_sha256; `mapDownloadLink` the grid below `link`; `mapHash`
/// the SHA-256 of the grid's file, in hex. Throws std::runtime_error naming the file that cannot be read or
/// written.
void write_map_identification(const MapCopy& map, const std::string& name, const std::string& link,
                              const std::string& directory);

}  // namespace isthmus
