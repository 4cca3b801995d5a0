#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace isthmus {

/// An event of a journal that brings the engine down: every reader of the journal skips it.
struct SetAside {
  std::int64_t utime = 0;
  std::string robot;  ///< empty: none's
  std::string channel;
  std::string reason;
};
using SetAsideEvents = std::map<std::int64_t, SetAside>;  ///< by their sequence in the journal

/// Those in a journal's set-aside.csv; none where there is no such file. Throws std::runtime_error naming
/// file, line and reason.
SetAsideEvents read_set_aside(const std::string& directory);

/// Writes the file anew, complete or not at all. Throws std::runtime_error naming the file and the reason.
void write_set_aside(const std::string& directory, const SetAsideEvents& events);

}  // namespace isthmus
