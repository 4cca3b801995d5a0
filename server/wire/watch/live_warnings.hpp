#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "isthmus/warning_t.hpp"
#include "server/engine/frozen/lost_robot.hpp"
#include "server/engine/record/map_copy.hpp"
#include "server/engine/record/self_check.hpp"
#include "server/wire/watch/log_line.hpp"

namespace isthmus {

/// Something that looks wrong, as long as it does. Of one kind and robot there is one.
struct LiveWarning {
  std::string kind;   ///< lower_case, the same in every release
  std::string robot;  ///< whose data; empty: no single robot's
  std::string text;   ///< a sentence for people
  std::int64_t begin_utime = 0;
};

/// Those of the robots' health, as report.json has them (engine/robot/health_warnings.hpp).
std::vector<LiveWarning> health_warnings_of(const MapCopy& map);

/// Robots that are not found on a finished map, and why.
std::vector<LiveWarning> warnings_of_lost(const std::vector<LostRobot>& robots);

/// Places and zones of which nothing is on the map any more.
std::vector<LiveWarning> warnings_of_annotations(const std::vector<AnnotationRecord>& annotations);

/// That the map contradicts itself, and where most.
std::vector<LiveWarning> warnings_of_contradictions(const std::vector<SelfContradiction>& found);

/// Keeps the warnings that hold, and tells the log of each once when it begins and once when it ends.
class LiveWarnings {
 public:
  /// `now`: all that hold at this time.
  void update(std::vector<LiveWarning> now, std::int64_t utime, const Log& log);

  /// In the order of their kinds and robots.
  const std::vector<LiveWarning>& current() const { return current_; }

 private:
  std::vector<LiveWarning> current_;
};

warning_t warning_message(const LiveWarning& warning);

}  // namespace isthmus
