#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/exploration/searched_area.hpp"
#include "server/paths/questions/frontiers.hpp"
#include "server/paths/questions/planner.hpp"

namespace isthmus {

/// How frontiers are given to robots.
enum class Sharing : std::uint8_t {
  routes,   ///< each robot the first of a route over its share of them (`share_out`)
  nearest,  ///< each the nearest to it, whatever others do (Yamauchi 1997): what others are compared with
};

struct ExplorationOptions {
  Sharing sharing = Sharing::routes;
  FrontierOptions frontiers{.min_gain_m2 = 0.3, .close_up = true};
  /// A robot that explores behind a frontier drives so far for each square metre of its gain.
  double work_m_per_m2 = 0.25;
  /// A frontier with its viewpoint so near to a robot's goal is what it drives to.
  double same_goal_m = 1.5;
  /// A robot does not go where it gave a goal up so near.
  double given_up_m = 0.5;
  /// Of one island, those of most gain.
  std::size_t max_frontiers = 60;
  SearchedArea search;  ///< with `routes` only
};

/// A robot that explores.
struct Explorer {
  ManifoldPose pose;
  Footprint footprint;
  std::optional<ManifoldPose> goal;    ///< that it drives to
  std::vector<ManifoldPose> given_up;  ///< goals that it could not come to
};

/// From where a robot shall look next.
struct ExplorationGoal {
  ManifoldPose viewpoint;  ///< it looks at the frontier's middle
  double size_m = 0;
  double gain_m2 = 0;
  double cost_m = 0;
};

/// Goals of a team's robots by name: a robot keeps the one that it drives to while that is a frontier. None
/// for a robot that stands nowhere, or for which nothing is left. On each island by itself: what robots of
/// two islands see in common is not known. A function of its arguments. `frontiers`: gets all that there
/// were to share out, at a cost of 0.
std::map<std::string, ExplorationGoal> share_frontiers(Planner& planner,
                                                       const std::map<std::string, Explorer>& team,
                                                       const ExplorationOptions& options = {},
                                                       std::vector<ExplorationGoal>* frontiers = nullptr);

}  // namespace isthmus
