#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "server/engine/input/drop_reason.hpp"

namespace isthmus {

/// Messages that were not taken, for one reason.
struct Dropped {
  std::int64_t count = 0;
  std::vector<std::int64_t> received;  ///< the numbers of those that are in the spool
};
using Drops = std::map<std::string, std::map<DropReason, Dropped>>;  ///< by sender and reason

}  // namespace isthmus
