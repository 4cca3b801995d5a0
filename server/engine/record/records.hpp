#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "server/engine/input/engine_options.hpp"
#include "server/engine/map/map.hpp"
#include "server/engine/record/counters.hpp"
#include "server/engine/robot/health_warnings.hpp"
#include "server/engine/robot/robot.hpp"
#include "server/engine/sightings/tag_record.hpp"

namespace isthmus {

/// What the engine knows of the data of its declared robots, by name.
std::vector<HealthRecord> health_records(const std::map<std::string, Robot>& robots, const Counters& counters,
                                         const EngineOptions& options);

/// The barcodes declared as tags and those placed, with where they are; `placed`: their patches, by barcode.
std::vector<TagRecord> tag_records(const Map& map, const std::set<std::int32_t>& declared,
                                   const std::map<std::int32_t, PatchId>& placed);

}  // namespace isthmus
