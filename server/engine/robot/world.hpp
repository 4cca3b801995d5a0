#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "server/engine/input/engine_options.hpp"
#include "server/engine/map/map.hpp"
#include "server/engine/robot/pose_history.hpp"
#include "server/engine/robot/robot.hpp"

namespace isthmus {

/// Where robots were, as it is written down for good.
class RecordedWays {
 public:
  /// Tells of a place of a robot where it is instead, the same place of the map as it was. Returns whether it
  /// is another.
  using Change = std::function<bool(const std::string& robot, PastPlace& place)>;

  virtual ~RecordedWays() = default;
  /// Changes where robots were since a time, but not when.
  virtual void correct(std::int64_t since_utime, const Change& change) = 0;
};

/// The map and the robots on it, lent for one call.
struct World {
  Map& map;
  std::map<std::string, Robot>& robots;
  const EngineOptions& options;
  std::int64_t now_utime = 0;  ///< receive time of the event
  bool no_more_waiting = false;
  RecordedWays* recorded = nullptr;  ///< if anything is
};

}  // namespace isthmus
