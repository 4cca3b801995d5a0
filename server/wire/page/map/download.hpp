#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/wire/page/map/shown_map.hpp"

namespace isthmus {

/// A file made of the map as it is.
struct Download {
  std::string name;
  std::string type;  ///< MIME
  std::string bytes;
};

/// `report.json` (of a map that is not finished, without what it cost) and `places.geojson`; and of the
/// island with the id N `island-N.png` and `island-N.yaml` (the grid as map_server has it; of at most 16
/// million cells, coarser where it would be more), `island-N-plan.svg`, `-plan.dxf` and `-plan.geojson`. In
/// `places.geojson` islands are told by their ids too. Nothing for any other name, and for islands that are
/// not there (any more). Takes up to seconds for a large map.
std::optional<Download> make_download(const ShownMap& shown, std::string_view name);

}  // namespace isthmus
