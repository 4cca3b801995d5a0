#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <tuple>

#include "isthmus/manifold_pose_t.hpp"
#include "isthmus/status_t.hpp"
#include "server/engine/engine.hpp"

namespace isthmus {

/// The server's own figures, beside the engine's counters.
struct ServerCounters {
  std::int32_t queued = 0;
  std::int64_t journal_bytes = 0;
  std::int64_t journal_failures = 0;
  std::int64_t journal_waiting = 0;
  std::int64_t publish_failures = 0;
  std::int64_t clock_steps = 0;
  std::map<std::string, std::int64_t> questions = {};  ///< "answered", or by reason of refusal
};

/// Keeps, for ISTHMUS_STATUS, when and how often each robot was heard and how its scans fared.
class RobotMonitor {
 public:
  void heard(const std::string& robot, std::int64_t utime);
  void answered(const RobotPose& pose);

  /// What was counted so far was no live traffic: it says nothing of rates.
  void forget_rates();

  /// `elapsed_s` since the status before, for the rates.
  status_t status(const MapCopy& map, const ServerCounters& server, std::int64_t utime, double elapsed_s);

  auto members() { return std::tie(robots_); }

 private:
  struct Robot {
    std::int64_t last_heard_utime = 0;
    std::int64_t messages_since = 0;  ///< since the last status
    std::int64_t scans_since = 0;
    std::int64_t scans = 0;
    std::int64_t scans_matched = 0;
    double message_rate_hz = 0;
    double scan_rate_hz = 0;

    auto members() {
      return std::tie(last_heard_utime, messages_since, scans_since, scans, scans_matched, message_rate_hz,
                      scan_rate_hz);
    }
  };

  static robot_status_t status_of(const std::string& name, const Robot& robot, const MapCopy& map);

  std::map<std::string, Robot> robots_;
};

manifold_pose_t pose_message(const RobotPose& pose);

}  // namespace isthmus
