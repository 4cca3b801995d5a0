#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/exploration/routes.hpp"
#include "server/paths/questions/frontiers.hpp"
#include "server/paths/questions/planner.hpp"

namespace isthmus {

/// Ground around a place, by its name on the map, that is explored before all other.
struct SearchedArea {
  std::string place;  ///< empty: none
  double radius_m = 5;
};

/// Where the place lies in an island's plane; nothing where none of that name does.
std::optional<Eigen::Vector2d> place_to_search(const Planner& planner, IslandId island,
                                               const SearchedArea& area);

/// By frontier, whether it comes before others: those in the area; or, as long as nobody has seen the place
/// and none is, the one over which the way there, straight on from it, is shortest for some robot.
std::vector<bool> frontiers_to_search(const Ground& ground, std::span<const Frontier> frontiers,
                                      const RouteCosts& costs, const Eigen::Vector2d& place, double radius_m);

}  // namespace isthmus
