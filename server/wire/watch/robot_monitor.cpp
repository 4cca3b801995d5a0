#include "server/wire/watch/robot_monitor.hpp"

#include <algorithm>

#include "server/wire/message/path_pose.hpp"

namespace isthmus {
namespace {

/// Weight of the newest interval in a smoothed rate: about the last five.
constexpr double newest_weight = 0.3;

double smoothed(double rate_hz, std::int64_t count, double elapsed_s) {
  if (elapsed_s <= 0) return rate_hz;
  return rate_hz + newest_weight * (static_cast<double>(count) / elapsed_s - rate_hz);
}

std::string as_text(DropReason reason) { return std::string(word(reason)); }
const std::string& as_text(const std::string& reason) { return reason; }

template <class Reason>
std::vector<count_t> to_counts(const std::map<Reason, std::int64_t>& by_reason) {
  std::vector<count_t> counts;
  for (const auto& [reason, count] : by_reason) {
    count_t one{};
    one.reason = as_text(reason);
    one.count = count;
    counts.push_back(one);
  }
  return counts;
}

std::int32_t count_closures(const MapCopy& map, ClosureState state) {
  return static_cast<std::int32_t>(
      std::count_if(map.closures.begin(), map.closures.end(),
                    [&](const ClosureRecord& closure) { return closure.state == state; }));
}

void count_meetings(const MapCopy& map, status_t& status) {
  status.closures = count_closures(map, ClosureState::accepted);
  status.closures_refused = count_closures(map, ClosureState::refused);
  status.closures_waiting = count_closures(map, ClosureState::waiting);
  status.closures_withdrawn = count_closures(map, ClosureState::withdrawn);
  status.sightings_accepted = map.sightings.count(Verdict::accepted);
  status.sightings_refused = map.sightings.count(Verdict::refused);
  status.sightings_waiting = map.sightings.count(Verdict::waiting);
}

}  // namespace

void RobotMonitor::heard(const std::string& robot, std::int64_t utime) {
  if (robot.empty()) return;
  Robot& entry = robots_[robot];
  entry.last_heard_utime = utime;
  entry.messages_since += 1;
}

void RobotMonitor::answered(const RobotPose& pose) {
  Robot& entry = robots_[pose.robot];
  entry.scans_since += 1;
  entry.scans += 1;
  entry.scans_matched += pose.matched ? 1 : 0;
}

void RobotMonitor::forget_rates() {
  for (auto& [name, robot] : robots_) robot.messages_since = robot.scans_since = 0;
}

status_t RobotMonitor::status(const MapCopy& map, const ServerCounters& server, std::int64_t utime,
                              double elapsed_s) {
  status_t status{};
  status.utime = utime;
  status.events = map.counters.events;
  status.scans = map.counters.scans;
  status.scans_matched = map.counters.scans_matched;
  status.sightings = map.counters.sightings;
  status.patches = static_cast<std::int32_t>(map.patches.size());
  status.relations = static_cast<std::int32_t>(map.graph.relations().size());
  status.islands = static_cast<std::int32_t>(map.graph.islands().size() + map.feature_islands);
  count_meetings(map, status);
  status.queued = server.queued;
  status.journal_bytes = server.journal_bytes;
  status.journal_failures = server.journal_failures;
  status.journal_waiting = server.journal_waiting;
  status.publish_failures = server.publish_failures;
  status.clock_steps = server.clock_steps;
  status.questions = to_counts(server.questions);
  status.nquestions = static_cast<std::int32_t>(status.questions.size());
  status.dropped = to_counts(map.counters.dropped);
  status.ndropped = static_cast<std::int32_t>(status.dropped.size());
  for (auto& [name, robot] : robots_) {
    robot.message_rate_hz = smoothed(robot.message_rate_hz, robot.messages_since, elapsed_s);
    robot.scan_rate_hz = smoothed(robot.scan_rate_hz, robot.scans_since, elapsed_s);
    robot.messages_since = robot.scans_since = 0;
  }
  std::map<std::string, Robot> shown = robots_;
  for (const auto& [name, dropped] : map.counters.dropped_by_robot) shown.try_emplace(name);
  for (const auto& [name, robot] : shown) status.robots.push_back(status_of(name, robot, map));
  status.nrobots = static_cast<std::int32_t>(status.robots.size());
  return status;
}

robot_status_t RobotMonitor::status_of(const std::string& name, const Robot& robot, const MapCopy& map) {
  robot_status_t status{};
  status.robot = name;
  status.last_heard_utime = robot.last_heard_utime;
  status.message_rate_hz = robot.message_rate_hz;
  status.scan_rate_hz = robot.scan_rate_hz;
  status.scans = robot.scans;
  status.share_matched =
      robot.scans > 0 ? static_cast<double>(robot.scans_matched) / static_cast<double>(robot.scans) : 0;
  const auto dropped = map.counters.dropped_by_robot.find(name);
  if (dropped != map.counters.dropped_by_robot.end()) status.dropped = to_counts(dropped->second);
  status.ndropped = static_cast<std::int32_t>(status.dropped.size());
  return status;
}

manifold_pose_t pose_message(const RobotPose& pose) {
  manifold_pose_t message{};
  message.utime = pose.utime;
  message.robot = pose.robot;
  message.island = pose.island.value;
  message.patch = pose.pose.patch.value;
  set_pose(message.patch_from_robot, pose.pose.patch_from_object);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) message.covariance[row][column] = pose.covariance(row, column);
  }
  set_pose(message.map_from_robot, pose.map_from_robot);
  set_pose(message.map_from_odom, pose.map_from_odom);
  message.matched = pose.matched ? 1 : 0;
  return message;
}

}  // namespace isthmus
