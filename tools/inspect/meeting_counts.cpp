#include "tools/inspect/meeting_counts.hpp"

#include <filesystem>
#include <iterator>
#include <optional>
#include <span>
#include <sstream>
#include <vector>

#include "server/engine/map/dependencies.hpp"
#include "tools/text/csv.hpp"

namespace isthmus {
namespace {

void add_sighting(Verdict verdict, const std::string& reason, std::int64_t closure, MeetingCounts& counts) {
  ++counts.sightings_by_verdict[verdict];
  if (verdict == Verdict::refused) ++counts.refused_by_reason[reason];
  if (closure >= 0) ++counts.by_closure[closure].sightings;
}

void add_relation(std::int64_t closure, std::span<const std::int64_t> depends_on, MeetingCounts& counts) {
  if (closure >= 0) ++counts.by_closure[closure].relations;
  for (const std::int64_t other : depends_on)
    if (other != closure) ++counts.by_closure[other].dependents;
}

Verdict verdict_of(const CsvReader& csv) {
  const std::optional<Verdict> verdict = value_of<Verdict>(csv.text("verdict"));
  if (!verdict) csv.fail("'" + csv.text("verdict") + "' is no verdict");
  return *verdict;
}

/// Ids, a blank between.
std::vector<std::int64_t> ids_of(const std::string& text) {
  std::istringstream words(text);
  return {std::istream_iterator<std::int64_t>(words), {}};
}

}  // namespace

MeetingCounts count_meetings(const MapCopy& map) {
  MeetingCounts counts;
  for (const SightingRecord& record : map.sightings) {
    add_sighting(record.verdict, std::string(word(record.reason)), record.closure.value, counts);
  }
  const Dependencies dependencies(map.graph);
  for (const auto& [id, relation] : map.graph.relations()) {
    std::vector<std::int64_t> depends_on;
    for (const ClosureId closure : dependencies.of(id)) depends_on.push_back(closure.value);
    add_relation(relation.origin.closure.value, depends_on, counts);
  }
  return counts;
}

MeetingCounts read_meeting_counts(const std::string& directory) {
  MeetingCounts counts;
  if (const std::string file = directory + "/sightings.csv"; std::filesystem::exists(file)) {
    CsvReader csv(file);
    while (csv.next()) add_sighting(verdict_of(csv), csv.text("reason"), csv.integer("closure"), counts);
  }
  if (const std::string file = directory + "/relations.csv"; std::filesystem::exists(file)) {
    CsvReader csv(file);
    const bool knows = csv.has_column("depends_on");
    while (csv.next())
      add_relation(csv.integer("closure"), ids_of(knows ? csv.text("depends_on") : ""), counts);
  }
  return counts;
}

}  // namespace isthmus
