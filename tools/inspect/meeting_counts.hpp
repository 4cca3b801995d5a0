#pragma once

#include <map>
#include <string>

#include "server/engine/record/map_copy.hpp"

namespace isthmus {

/// What belongs to one closure.
struct ClosureParts {
  int sightings = 0;
  int relations = 0;
  int dependents = 0;  ///< relations of others that depend on it
};

/// What became of the sightings, and which of them and of the relations belong to which closure.
struct MeetingCounts {
  std::map<Verdict, int> sightings_by_verdict;
  std::map<std::string, int> refused_by_reason;  ///< by its word: that of a table may be an earlier version's
  std::map<std::int64_t, ClosureParts> by_closure;
};

MeetingCounts count_meetings(const MapCopy& map);

/// The same from an output directory's sightings.csv and relations.csv; nothing of a table that is not there.
/// Throws FileError naming file and line.
MeetingCounts read_meeting_counts(const std::string& directory);

}  // namespace isthmus
