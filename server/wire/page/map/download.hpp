#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/engine/record/map_copy.hpp"

namespace isthmus {

/// A file made of the map as it is.
struct Download {
  std::string name;
  std::string type;  ///< MIME
  std::string bytes;
};

/// `report.json` (of a map that is not finished, without what it cost) and `places.geojson`; and for K, the
/// number of an island in these: `island-K.png` and `island-K.yaml` (the grid as map_server has it; of at
/// most 16 million cells, coarser where it would be more), `island-K-plan.svg`, `-plan.dxf` and
/// `-plan.geojson`. Nothing for any other name, and for islands that are not there. Takes up to seconds for a
/// large map.
std::optional<Download> make_download(const MapCopy& map, std::string_view name);

}  // namespace isthmus
