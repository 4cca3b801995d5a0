#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tools/simulate/campaigns/confidence/confidence.hpp"
#include "tools/simulate/scenario/scenario_file.hpp"
#include "tools/simulate/truth/truth_files.hpp"

namespace isthmus {

/// A simulated run and the map that the engine made of it.
struct SimulatedMap {
  SimulatedRun run;
  MapCopy map;
};

inline SimulatedMap map_scenario(const std::string& scenario, const std::vector<std::string>& overrides = {},
                                 std::uint64_t seed = 1) {
  SimulatedMap result{simulate(load_scenario(scenario, overrides), seed), {}};
  result.map = map_events(result.run.events);
  return result;
}

/// What a map's final trajectory makes of a true relation.
struct TrajectoryError {
  std::size_t relations = 0;
  std::size_t missing = 0;
  double mean_m = 0;
  double mean_rad = 0;
  double max_m = 0;
};

/// Judges the trajectories by the relations within each robot's run (kind intra), of scans from a time on.
inline TrajectoryError judge_trajectories(const SimulatedMap& simulated, std::int64_t from_utime = 0) {
  const MapCopy& map = simulated.map;
  std::map<std::pair<std::string, std::int64_t>, Pose> poses;
  for (const TrajectoryRow& row : map.trajectory->read(0, map.trajectory_rows)) {
    const std::string& robot = map.sessions.at(static_cast<std::size_t>(row.session)).robot;
    poses[{robot, row.utime}] =
        map.poses.at(static_cast<std::size_t>(row.patch.value)) * row.patch_from_robot;
  }
  TrajectoryError error;
  for (const ScanRelation& r : sample_relations(simulated.run.truth, 1)) {
    if (r.robot1 != r.robot2 || std::min(r.utime1, r.utime2) < from_utime) continue;
    const auto a = poses.find({r.robot1, r.utime1}), b = poses.find({r.robot2, r.utime2});
    if (a == poses.end() || b == poses.end()) {
      ++error.missing;
      continue;
    }
    const Pose estimate = ominus(b->second, a->second);
    const double off_m = std::hypot(estimate.x - r.pose.x, estimate.y - r.pose.y);
    ++error.relations;
    error.mean_m += off_m;
    error.max_m = std::max(error.max_m, off_m);
    error.mean_rad += std::abs(wrap_angle(estimate.yaw - r.pose.yaw));
  }
  if (error.relations > 0) {
    error.mean_m /= static_cast<double>(error.relations);
    error.mean_rad /= static_cast<double>(error.relations);
  }
  return error;
}

/// The islands that a robot's patches are on.
inline std::set<IslandId> islands_of(const MapCopy& map, const std::string& robot) {
  std::set<IslandId> islands;
  for (const PatchPtr& patch : map.patches) {
    if (patch->robot == robot) islands.insert(map.graph.island(patch->id));
  }
  return islands;
}

inline std::vector<Session> sessions_of(const MapCopy& map, const std::string& robot) {
  std::vector<Session> sessions;
  for (const Session& session : map.sessions) {
    if (session.robot == robot) sessions.push_back(session);
  }
  return sessions;
}

}  // namespace isthmus
