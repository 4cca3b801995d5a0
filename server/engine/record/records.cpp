#include "server/engine/record/records.hpp"

#include <utility>

namespace isthmus {

std::vector<HealthRecord> health_records(const std::map<std::string, Robot>& robots, const Counters& counters,
                                         const EngineOptions& options) {
  std::vector<HealthRecord> records;
  for (const auto& [name, robot] : robots) {
    if (!robot.declared) continue;
    const auto found = counters.dropped_by_robot.find(name);
    const bool any = found != counters.dropped_by_robot.end();
    const std::map<DropReason, std::int64_t> dropped =
        any ? found->second : std::map<DropReason, std::int64_t>{};
    HealthRecord record{name, robot.health.figures(options.health), {}};
    record.scan_delay_s = 1e-6 * static_cast<double>(robot.scan_delay.us());
    record.warnings =
        health_warnings(name, robot.declaration.laser, record.figures, dropped, options.health_warnings);
    records.push_back(std::move(record));
  }
  return records;
}

std::vector<TagRecord> tag_records(const Map& map, const std::set<std::int32_t>& declared,
                                   const std::map<std::int32_t, PatchId>& placed) {
  std::map<std::int32_t, TagRecord> records;
  for (const std::int32_t barcode : declared) records[barcode].barcode = barcode;
  for (const auto& [barcode, patch] : placed) {
    TagRecord& record = records[barcode];
    record.barcode = barcode;
    record.patch = patch;
    record.island = map.graph().island(patch);
    record.position = {map.manifold().pose(patch).x, map.manifold().pose(patch).y};
    record.placed = true;
  }
  std::vector<TagRecord> all;
  for (const auto& [barcode, record] : records) all.push_back(record);
  return all;
}

}  // namespace isthmus
