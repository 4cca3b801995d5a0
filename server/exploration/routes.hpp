#pragma once

#include <cstddef>
#include <limits>
#include <vector>

namespace isthmus {

/// The cost where there is no way.
inline constexpr double no_way = std::numeric_limits<double>::infinity();

/// What it takes robots to go to places and work there, in metres that a robot drives meanwhile; no_way where
/// there is none.
struct RouteCosts {
  std::vector<std::vector<double>> from_robot;  ///< by robot and place
  std::vector<std::vector<double>> between;     ///< by place and place, the same both ways
  std::vector<double> work;                     ///< by place
};

/// The places that a robot goes to, in order.
using Route = std::vector<std::size_t>;

/// Metres until the last place of a route is done; 0 for an empty one.
double route_m(const RouteCosts& costs, std::size_t robot, const Route& route);

/// Shares places out among robots, each place that somebody can reach to one of them, so that the longest
/// route, what all routes take on average, and what a place waits on average until a robot is there, by its
/// work, are short together: cheapest insertion, then moves of one place and turns of a stretch as long as
/// they help (the min-max travelling salesmen of Franca et al. 1995, and the travelling repairman). By robot.
/// Bounded work, the same for the same costs.
std::vector<Route> share_out(const RouteCosts& costs);

}  // namespace isthmus
