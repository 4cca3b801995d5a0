#pragma once

#include <string>

#include "tools/replay/replay.hpp"

namespace isthmus {

/// A run in few lines: scans and share matched, patches, islands, cost, map_sha256.
std::string summary_text(const ReplayResult& result, const MapCopy& map);
std::string summary_json(const ReplayResult& result, const MapCopy& map);

}  // namespace isthmus
