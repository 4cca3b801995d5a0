#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "server/engine/input/engine_options.hpp"
#include "server/engine/map/map.hpp"
#include "server/engine/robot/robot.hpp"

namespace isthmus {

/// The map and the robots on it, lent for one call.
struct World {
  Map& map;
  std::map<std::string, Robot>& robots;
  const EngineOptions& options;
  std::int64_t now_utime = 0;  ///< receive time of the event
  bool no_more_waiting = false;
};

}  // namespace isthmus
