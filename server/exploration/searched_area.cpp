#include "server/exploration/searched_area.hpp"

#include <algorithm>

#include "server/engine/annotations/annotations.hpp"
#include "server/paths/questions/relative_pose.hpp"

namespace isthmus {

std::optional<Eigen::Vector2d> place_to_search(const Planner& planner, IslandId island,
                                               const SearchedArea& area) {
  if (area.place.empty()) return std::nullopt;
  const MapCopy& map = planner.map();
  for (const AnnotationRecord& one : map.annotations) {
    if (one.kind != AnnotationKind::place || one.lost || !is_same_name(one.name, area.place)) continue;
    const ManifoldPose at{one.points.front().patch, one.points.front().patch_from_object};
    if (check(map, at) == Refusal::none && map.graph.island(at.patch) == island)
      return position(planner.project(at));
  }
  return std::nullopt;
}

std::vector<bool> frontiers_to_search(const Ground& ground, std::span<const Frontier> frontiers,
                                      const RouteCosts& costs, const Eigen::Vector2d& place,
                                      double radius_m) {
  std::vector<bool> first(frontiers.size(), false);
  bool any = false;
  double shortest_m = no_way;
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < frontiers.size(); ++i) {
    double way_m = no_way;
    for (const std::vector<double>& row : costs.from_robot) way_m = std::min(way_m, row[i]);
    if (way_m == no_way) continue;
    const double left_m = (frontiers[i].middle - place).norm();
    first[i] = left_m <= radius_m;
    any = any || first[i];
    if (way_m + left_m >= shortest_m) continue;
    shortest_m = way_m + left_m;
    nearest = i;
  }
  const auto [seen, end] = ground.at(cell_of(place));
  if (!any && seen == end && shortest_m < no_way) first[nearest] = true;
  return first;
}

}  // namespace isthmus
