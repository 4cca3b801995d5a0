#pragma once

#include <string>

#include "server/output/output.hpp"
#include "server/output/tables/islands.hpp"

namespace isthmus {

/// The text of report.json: what was counted, what it cost, the closures, and the map's SHA-256.
std::string report_json(const MapCopy& map, const RankedIslands& islands, const RunCost& cost);

void write_report(const MapCopy& map, const RankedIslands& islands, const RunCost& cost,
                  const std::string& path);

}  // namespace isthmus
