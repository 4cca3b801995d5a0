#include "server/exploration/explore.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/exploration/routes.hpp"
#include "server/paths/questions/relative_pose.hpp"
#include "server/paths/roads/route.hpp"

namespace isthmus {
namespace {

using NamedExplorer = std::pair<const std::string, Explorer>;

/// The frontiers of an island, and what it takes its robots to go to them.
class IslandShare {
 public:
  IslandShare(Planner& planner, IslandId island, const std::vector<const NamedExplorer*>& members,
              const ExplorationOptions& options)
      : planner_(planner), island_(island), options_(options) {
    Footprint footprint{0, 0};
    for (const NamedExplorer* member : members) {
      footprint.radius_m = std::max(footprint.radius_m, member->second.footprint.radius_m);
      footprint.clearance_m = std::max(footprint.clearance_m, member->second.footprint.clearance_m);
    }
    roadmap_ = check(footprint) == Refusal::none ? planner.roadmap(island, footprint) : nullptr;
    if (!roadmap_) return;
    for (const NamedExplorer* member : members) {
      const NodeId node = planner.room_near(*roadmap_, member->second.pose, PathQuestion{}.start_tolerance_m);
      if (node < 0) continue;
      members_.push_back(member);
      nodes_.push_back(node);
    }
    find_all_frontiers();
  }

  void share(std::map<std::string, ExplorationGoal>& goals) const {
    if (members_.empty() || frontiers_.empty()) return;
    const RouteCosts costs = all_costs();
    std::vector<std::optional<std::size_t>> places = kept_places(costs);
    const bool alone = options_.sharing == Sharing::nearest;
    if (!alone) search_first(costs, places);
    const auto chosen = alone ? nearest_places(costs) : first_places(wished_costs(costs, places));
    for (std::size_t robot = 0; robot < members_.size(); ++robot) {
      if (!places[robot]) places[robot] = chosen[robot];
      if (const auto place = places[robot])
        goals[members_[robot]->first] = goal(*place, costs.from_robot[robot][*place]);
    }
  }

  void list(std::vector<ExplorationGoal>& frontiers) const {
    for (std::size_t place = 0; place < frontiers_.size(); ++place) frontiers.push_back(goal(place, 0));
  }

 private:
  /// Robots are sent to what is to be searched, whatever else they drive to; those that it does not take go
  /// on.
  void search_first(const RouteCosts& costs, std::vector<std::optional<std::size_t>>& places) const {
    const auto place = place_to_search(planner_, island_, options_.search);
    if (!place) return;
    const std::vector<bool> first =
        frontiers_to_search(roadmap_->ground(), frontiers_, costs, *place, options_.search.radius_m);
    std::vector<std::optional<std::size_t>> kept = places;
    for (auto& one : kept)
      if (one && !first[*one]) one.reset();
    RouteCosts searched = wished_costs(costs, kept);
    for (std::vector<double>& row : searched.from_robot)
      for (std::size_t i = 0; i < first.size(); ++i)
        if (!first[i]) row[i] = no_way;
    const auto chosen = first_places(searched);
    for (std::size_t robot = 0; robot < places.size(); ++robot)
      if (!kept[robot] && chosen[robot]) places[robot] = chosen[robot];
  }

  /// With viewpoints that robots can come to: what lies behind a gap is looked at from this side of it. Where
  /// known ground is in parts, as while robots that begin hide one another's, there are some in each part
  /// that a robot is on.
  void find_all_frontiers() {
    std::vector<bool> reached(roadmap_->squares(), false);
    for (const NodeId node : nodes_) {
      if (reached[static_cast<std::size_t>(roadmap_->square(node))]) continue;
      const std::vector<float> lengths = costs_from(*roadmap_, node);
      for (std::size_t square = 0; square < lengths.size(); ++square)
        if (std::isfinite(lengths[square])) reached[square] = true;
      for (const Frontier& frontier : find_frontiers(*roadmap_, node, options_.frontiers))
        if (frontier.viewpoint >= 0 && frontiers_.size() < options_.max_frontiers)
          frontiers_.push_back(frontier);
    }
  }

  RouteCosts all_costs() const {
    RouteCosts costs;
    for (const NodeId node : nodes_) {
      const std::vector<float> lengths = costs_from(*roadmap_, node);
      std::vector<double>& row = costs.from_robot.emplace_back();
      for (const Frontier& frontier : frontiers_) {
        const float length = lengths[static_cast<std::size_t>(roadmap_->square(frontier.viewpoint))];
        row.push_back(std::isfinite(length) ? static_cast<double>(length) : no_way);
      }
    }
    for (const Frontier& frontier : frontiers_) {
      costs.work.push_back(options_.work_m_per_m2 * frontier.gain_m2);
      const std::vector<float> lengths =
          roadmap_->regions().lengths_from(roadmap_->square(frontier.viewpoint));
      std::vector<double>& row = costs.between.emplace_back();
      for (const Frontier& other : frontiers_) {
        const std::int32_t region = roadmap_->regions().of(roadmap_->square(other.viewpoint));
        const float length = lengths[static_cast<std::size_t>(region)];
        row.push_back(std::isfinite(length) ? static_cast<double>(length) : no_way);
      }
    }
    return costs;
  }

  /// What robots drive to already and is a frontier still; of several that drive to one, the nearest.
  std::vector<std::optional<std::size_t>> kept_places(const RouteCosts& costs) const {
    std::vector<std::optional<std::size_t>> kept(members_.size());
    for (std::size_t robot = 0; robot < members_.size(); ++robot) {
      const auto& goal = members_[robot]->second.goal;
      if (!goal) continue;
      double min_m = options_.same_goal_m;
      for (std::size_t place = 0; place < frontiers_.size(); ++place) {
        const double apart_m = distance_m(place, *goal);
        if (!(apart_m <= min_m) || gave_up(robot, place) || costs.from_robot[robot][place] == no_way)
          continue;
        min_m = apart_m;
        kept[robot] = place;
      }
      if (options_.sharing == Sharing::nearest) continue;
      for (std::size_t other = 0; other < robot; ++other) {
        if (!kept[robot] || kept[other] != kept[robot]) continue;
        const bool nearer = costs.from_robot[robot][*kept[robot]] < costs.from_robot[other][*kept[robot]];
        kept[nearer ? other : robot].reset();
      }
    }
    return kept;
  }

  /// A robot that drives to a place goes on from there; nobody else goes there, and nobody to what it gave
  /// up.
  RouteCosts wished_costs(const RouteCosts& costs,
                          const std::vector<std::optional<std::size_t>>& kept) const {
    RouteCosts wished = costs;
    for (std::size_t robot = 0; robot < members_.size(); ++robot) {
      std::vector<double>& row = wished.from_robot[robot];
      for (std::size_t place = 0; place < frontiers_.size(); ++place) {
        if (kept[robot])
          row[place] = costs.from_robot[robot][*kept[robot]] + costs.work[*kept[robot]] +
                       costs.between[*kept[robot]][place];
        if (gave_up(robot, place)) row[place] = no_way;
      }
      for (const auto& place : kept)
        if (place) row[*place] = no_way;
    }
    return wished;
  }

  static std::vector<std::optional<std::size_t>> first_places(const RouteCosts& costs) {
    std::vector<std::optional<std::size_t>> first(costs.from_robot.size());
    const std::vector<Route> routes = share_out(costs);
    for (std::size_t robot = 0; robot < routes.size(); ++robot)
      if (!routes[robot].empty()) first[robot] = routes[robot].front();
    return first;
  }

  std::vector<std::optional<std::size_t>> nearest_places(const RouteCosts& costs) const {
    std::vector<std::optional<std::size_t>> nearest(members_.size());
    for (std::size_t robot = 0; robot < members_.size(); ++robot) {
      double least = no_way;
      for (std::size_t place = 0; place < frontiers_.size(); ++place) {
        const double cost = costs.from_robot[robot][place];
        if (!(cost < least) || gave_up(robot, place)) continue;
        least = cost;
        nearest[robot] = place;
      }
    }
    return nearest;
  }

  /// Of a frontier's viewpoint from a pose, in the island's plane; no_way where that is not on the island.
  double distance_m(std::size_t place, const ManifoldPose& pose) const {
    const bool is_here =
        check(planner_.map(), pose) == Refusal::none && planner_.map().graph.island(pose.patch) == island_;
    if (!is_here) return no_way;
    const Eigen::Vector2d at = roadmap_->ground().centre(frontiers_[place].viewpoint);
    return (position(planner_.project(pose)) - at).norm();
  }

  bool gave_up(std::size_t robot, std::size_t place) const {
    const std::vector<ManifoldPose>& poses = members_[robot]->second.given_up;
    return std::any_of(poses.begin(), poses.end(), [&](const ManifoldPose& pose) {
      return distance_m(place, pose) <= options_.given_up_m;
    });
  }

  ExplorationGoal goal(std::size_t place, double cost_m) const {
    const Frontier& frontier = frontiers_[place];
    const Ground& ground = roadmap_->ground();
    const Eigen::Vector2d point = ground.centre(frontier.viewpoint), by = frontier.middle - point;
    const PatchId leader = ground.layer(frontier.viewpoint).leader;
    const Pose& map_from_patch = planner_.map().poses[static_cast<std::size_t>(leader.value)];
    const Pose map_from_viewpoint{point.x(), point.y(), std::atan2(by.y(), by.x())};
    return {{leader, ominus(map_from_viewpoint, map_from_patch)}, frontier.size_m, frontier.gain_m2, cost_m};
  }

  const Planner& planner_;
  IslandId island_;
  const ExplorationOptions& options_;
  std::shared_ptr<const Roadmap> roadmap_;
  std::vector<const NamedExplorer*> members_;
  std::vector<NodeId> nodes_;  // where they are
  std::vector<Frontier> frontiers_;
};

}  // namespace

std::map<std::string, ExplorationGoal> share_frontiers(Planner& planner,
                                                       const std::map<std::string, Explorer>& team,
                                                       const ExplorationOptions& options,
                                                       std::vector<ExplorationGoal>* frontiers) {
  std::map<IslandId, std::vector<const NamedExplorer*>> islands;
  for (const NamedExplorer& member : team)
    if (check(planner.map(), member.second.pose) == Refusal::none)
      islands[planner.map().graph.island(member.second.pose.patch)].push_back(&member);
  std::map<std::string, ExplorationGoal> goals;
  for (const auto& [island, members] : islands) {
    const IslandShare share(planner, island, members, options);
    share.share(goals);
    if (frontiers) share.list(*frontiers);
  }
  return goals;
}

}  // namespace isthmus
