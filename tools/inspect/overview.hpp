#pragma once

#include <string>

#include "tools/inspect/meeting_counts.hpp"

namespace isthmus {

/// A report.json as a page to read: counters, islands, sessions and closures with what belongs to them.
/// Throws std::runtime_error naming `file` and the reason where the text is no such report.
std::string overview(const std::string& report_json, const MeetingCounts& meetings, const std::string& file);

}  // namespace isthmus
