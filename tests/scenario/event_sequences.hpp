#pragma once

#include <algorithm>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/engine/engine.hpp"
#include "tests/scenario/simulated_maps.hpp"

namespace isthmus {

using Events = std::vector<Event>;

/// Time of a run, from its first event on.
inline std::int64_t after_s(const Events& events, double seconds) {
  return events.front().receive_utime + static_cast<std::int64_t>(seconds * 1e6);
}

/// Put among the events by its receive time, after those of the same.
inline void insert(Events& events, Event event) {
  const auto at = std::ranges::upper_bound(events, event.receive_utime, {}, &Event::receive_utime);
  events.insert(at, std::move(event));
}

inline Event command(std::int64_t utime, Verb verb, std::int64_t closure = -1) {
  return {utime, CommandEvent{utime, verb, closure, ""}};
}

/// The events of one robot come so much later than they were sent.
inline Events delayed(Events events, const std::string& robot, std::int64_t by_us) {
  for (Event& event : events) {
    const bool its = std::visit(
        [&](const auto& body) {
          if constexpr (requires { body.robot; }) return body.robot == robot;
          return false;
        },
        event.body);
    if (its && !std::holds_alternative<RobotEvent>(event.body)) event.receive_utime += by_us;
  }
  std::ranges::stable_sort(events, {}, &Event::receive_utime);
  return events;
}

/// Two robots of a small office that pass one another twice.
inline const SimulatedRun& meeting() {
  static const SimulatedRun run = simulate(load_scenario("meeting"), 1);
  return run;
}

/// An engine after a run's events but not finished, and why it dropped which of them.
struct Played {
  Engine engine;
  std::vector<DropReason> drop_reasons;
};

/// Plays events up to a time (all, where it is 0).
inline Played play(const Events& events, std::int64_t until_utime = 0,
                   const Configuration& configuration = {}) {
  Played played{Engine(configuration), {}};
  for (const Event& event : events) {
    if (until_utime != 0 && event.receive_utime > until_utime) break;
    const Outcome outcome = played.engine.handle(event);
    if (outcome.drop_reason != DropReason::none) played.drop_reasons.push_back(outcome.drop_reason);
  }
  return played;
}

/// The record of a closure; one without an id where there is none.
inline ClosureRecord closure_of(const MapCopy& map, int id) {
  const auto found = std::ranges::find(map.closures, ClosureId{id}, &ClosureRecord::id);
  return found != map.closures.end() ? *found : ClosureRecord{};
}

/// In a word; "none" where there is none.
inline std::string state_of(const MapCopy& map, int id) {
  const ClosureRecord closure = closure_of(map, id);
  return closure.id.valid() ? std::string(word(closure.state)) : "none";
}

inline std::size_t relations_of(const MapCopy& map, ClosureId closure) {
  std::size_t count = 0;
  for (const auto& [id, relation] : map.graph.relations())
    if (relation.origin.closure == closure) ++count;
  return count;
}

inline std::size_t islands(const MapCopy& map) { return map.graph.islands().size(); }

/// By what two maps of the same scans differ: patches by robot and stamp, those of one robot laid on one
/// another by its first patch, as frames are free.
struct MapDifference {
  std::size_t compared = 0;
  std::size_t only_in_one = 0;
  double max_m = 0;
  double max_rad = 0;
};

inline MapDifference compare_patches(const MapCopy& a, const MapCopy& b,
                                     std::int64_t until_utime = std::numeric_limits<std::int64_t>::max()) {
  using Key = std::pair<std::string, std::int64_t>;
  const auto by_scan = [until_utime](const MapCopy& map) {
    std::map<Key, Pose> poses;
    for (std::size_t i = 0; i < map.patches.size(); ++i)
      if (map.patches[i]->utime <= until_utime)
        poses[{map.patches[i]->robot, map.patches[i]->utime}] = map.poses[i];
    return poses;
  };
  const auto of_a = by_scan(a), of_b = by_scan(b);
  MapDifference difference;
  std::map<std::string, std::pair<Pose, Pose>> first;
  for (const auto& [key, pose] : of_a) {
    const auto other = of_b.find(key);
    if (other == of_b.end()) {
      ++difference.only_in_one;
      continue;
    }
    const auto& [first_a, first_b] = first.emplace(key.first, std::pair(pose, other->second)).first->second;
    const Pose off = ominus(ominus(pose, first_a), ominus(other->second, first_b));
    ++difference.compared;
    difference.max_m = std::max(difference.max_m, std::hypot(off.x, off.y));
    difference.max_rad = std::max(difference.max_rad, std::abs(off.yaw));
  }
  for (const auto& [key, pose] : of_b) difference.only_in_one += of_a.contains(key) ? 0 : 1;
  return difference;
}

/// The trajectory that an engine has written so far.
inline std::shared_ptr<TrajectoryStore> rows_of(const Engine& engine) {
  const MapCopy map = engine.copy();
  auto rows = std::make_shared<TrajectoryStore>();
  for (const TrajectoryRow& row : map.trajectory->read(0, map.trajectory_rows)) rows->append(row);
  return rows;
}

}  // namespace isthmus
