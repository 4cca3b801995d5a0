#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/engine/record/map_copy.hpp"
#include "server/wire/watch/log_line.hpp"

namespace isthmus {

/// A log line for each verdict on a closure or merge: accepted, refused, withdrawn.
class ClosureLog {
 public:
  /// Logs the verdicts that are new since the call before.
  void tell(const std::vector<ClosureRecord>& closures, const Log& log);

 private:
  std::map<ClosureId, ClosureState> states_;
};

}  // namespace isthmus
