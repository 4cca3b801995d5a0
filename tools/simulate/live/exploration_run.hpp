#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/exploration/expedition.hpp"
#include "tools/simulate/run/simulation.hpp"

namespace isthmus {

struct ExplorationRunOptions {
  std::size_t robots = 1;  ///< the first of the scenario's; they start beside one another,
  bool apart = false;      ///< or where the scenario has them
  ExpeditionOptions expedition;
  double clearance_m = 0.1;  ///< asked of paths
  double max_s = 3600;       ///< the run is given up then
  double plan_period_s = 1;  ///< goals and paths are looked at anew
  double measure_period_s = 20;
  double found_share = 0.99;  ///< of the reachable ground: the time of this is told
};

/// What became of an exploration.
struct ExplorationScore {
  double reachable_m2 = 0;  ///< where a robot's centre can come to, from where they start
  double share = 0;         ///< of it that is on the map in the end
  double found_s = 0;       ///< when `found_share` of it was; 0: never
  double found_way_m = 0;   ///< that the team had driven by then
  double end_s = 0;         ///< when nothing was left to explore, or the run was given up
  double way_m = 0;         ///< of the whole team
  bool given_up = false;
  std::size_t islands = 0;         ///< with a robot on them, in the end
  double merged_s = 0;             ///< when all robots were on one for the first time; 0: never
  std::size_t touched_walls = 0;   ///< times that a robot came to touch one
  std::size_t touched_robots = 0;  ///< pairs that came to touch
  std::size_t gave_way = 0;        ///< times that one made way for another
  std::size_t goals = 0;           ///< that were driven to
  std::size_t goals_given_up = 0;
  double plan_cpu_ms = 0;  ///< of the dearest look at goals and paths, the ground's update included
};

/// A robot while the map is explored; all of it on one island of the planner's map.
struct ExploringRobot {
  ManifoldPose pose;
  std::optional<ManifoldPose> goal;  ///< from where it is to look
  /// That it drives now, its poses a metre apart at most: towards the goal as far as others let it, or out of
  /// their way. Empty: it stands.
  std::vector<ManifoldPose> way;
};

/// The map while it is explored, for those who draw it.
struct ExplorationView {
  double time_s = 0;
  const Planner& planner;
  std::map<std::string, ExploringRobot> team;
  std::map<std::string, std::vector<Eigen::Vector2d>> trails;  ///< true, from the start on
};
using WatchExploration = std::function<void(const ExplorationView&)>;

/// A robot and what it was told to drive, for those who write it down.
struct OrderView {
  double time_s = 0;
  const Planner& planner;
  const std::string& robot;
  Pose world_from_robot;  ///< true
  ManifoldPose pose;      ///< as the map has it
  const ExplorationOrder& order;
  double stuck_s = 0;  ///< for how long it has tried to get on and did not
};
using WatchOrders = std::function<void(const OrderView&)>;

/// Robots in the scenario's building, in a closed loop with the engine, the planner and `Expedition`, in
/// one process: they drive along the paths that they are given by what their own lasers see, and what they
/// send is what the map is made of. The same for the same arguments. `watch` is called after each
/// measurement, `watch_orders` for each order; both may be empty. Throws std::runtime_error where there is no
/// room for the robots to start.
ExplorationScore explore(const Scenario& scenario, std::uint64_t seed, const ExplorationRunOptions& options,
                         const WatchExploration& watch = {}, const WatchOrders& watch_orders = {});

}  // namespace isthmus
