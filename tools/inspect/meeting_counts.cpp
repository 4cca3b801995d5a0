#include "tools/inspect/meeting_counts.hpp"

#include <filesystem>

#include "tools/text/csv.hpp"

namespace isthmus {
namespace {

void add_sighting(const std::string& verdict, const std::string& reason, std::int64_t closure,
                  MeetingCounts& counts) {
  ++counts.sightings_by_verdict[verdict];
  if (verdict == "refused") ++counts.refused_by_reason[reason];
  if (closure >= 0) ++counts.by_closure[closure].sightings;
}

void add_relation(std::int64_t closure, MeetingCounts& counts) {
  if (closure >= 0) ++counts.by_closure[closure].relations;
}

}  // namespace

MeetingCounts count_meetings(const MapCopy& map) {
  MeetingCounts counts;
  for (const SightingRecord& record : map.sightings) {
    add_sighting(record.verdict, record.reason, record.closure.value, counts);
  }
  for (const auto& [id, relation] : map.graph.relations())
    add_relation(relation.origin.closure.value, counts);
  return counts;
}

MeetingCounts read_meeting_counts(const std::string& directory) {
  MeetingCounts counts;
  if (const std::string file = directory + "/sightings.csv"; std::filesystem::exists(file)) {
    CsvReader csv(file);
    while (csv.next()) add_sighting(csv.text("verdict"), csv.text("reason"), csv.integer("closure"), counts);
  }
  if (const std::string file = directory + "/relations.csv"; std::filesystem::exists(file)) {
    CsvReader csv(file);
    while (csv.next()) add_relation(csv.integer("closure"), counts);
  }
  return counts;
}

}  // namespace isthmus
