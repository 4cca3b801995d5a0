#pragma once

#include <string>

namespace isthmus {

/// A report.json as a page to read: counters, islands, sessions and closures. Throws std::runtime_error
/// naming `file` and the reason where the text is no such report.
std::string overview(const std::string& report_json, const std::string& file);

}  // namespace isthmus
