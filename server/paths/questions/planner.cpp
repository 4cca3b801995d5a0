#include "server/paths/questions/planner.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "server/paths/questions/relative_pose.hpp"
#include "server/paths/roads/pull.hpp"
#include "server/paths/roads/route.hpp"

namespace isthmus {
namespace {

constexpr std::size_t max_roadmaps = 8;
constexpr double pose_distance_m = 1;

bool within(double value, double low, double high) { return value >= low && value <= high; }

/// The first that is no none.
Refusal first_of(std::initializer_list<Refusal> refusals) {
  for (const Refusal refusal : refusals)
    if (refusal != Refusal::none) return refusal;
  return Refusal::none;
}

}  // namespace

Refusal check(const Footprint& footprint) {
  const bool fine = within(footprint.radius_m, 0, Planner::max_room_m) &&
                    within(footprint.clearance_m, 0, Planner::max_room_m) &&
                    footprint.radius_m + footprint.clearance_m <= Planner::max_room_m;
  return fine ? Refusal::none : Refusal::bad_value;
}

void Planner::update(std::shared_ptr<const MapCopy> map) {
  map_ = std::move(map);
  grounds_.update(*map_);
  Zones zones(*map_);
  std::erase_if(roadmaps_, [&](const auto& kept) {
    const auto island = std::get<IslandId>(kept.first);
    return !grounds_.ground(island) || !are_alike(zones.of(island), zones_.of(island));
  });
  // Zones that have hardly moved stay as the roadmaps have them, or they would creep away.
  for (const auto& [key, kept] : roadmaps_) zones.keep(std::get<IslandId>(key), zones_);
  zones_ = std::move(zones);
}

std::shared_ptr<const Roadmap> Planner::roadmap(IslandId island, const Footprint& footprint) {
  return roadmap(island, footprint, true);
}

std::shared_ptr<const Roadmap> Planner::roadmap(IslandId island, const Footprint& footprint,
                                                bool with_zones) {
  const auto ground = grounds_.ground(island);
  if (!ground) return nullptr;
  KeptRoadmap& kept = roadmaps_[{island, footprint.radius_m, footprint.clearance_m, with_zones}];
  const std::span<const Zone> zones = with_zones ? zones_.of(island) : std::span<const Zone>();
  if (!kept.roadmap || &kept.roadmap->ground() != ground.get())
    kept.roadmap = std::make_shared<const Roadmap>(ground, footprint, zones, kept.roadmap.get());
  kept.asked = ++asked_;
  std::shared_ptr<const Roadmap> found = kept.roadmap;
  if (roadmaps_.size() > max_roadmaps) {
    const auto oldest =
        std::min_element(roadmaps_.begin(), roadmaps_.end(),
                         [](const auto& a, const auto& b) { return a.second.asked < b.second.asked; });
    roadmaps_.erase(oldest);
  }
  return found;
}

Pose Planner::project(const ManifoldPose& pose) const {
  return map_->poses[static_cast<std::size_t>(pose.patch.value)] * pose.patch_from_object;
}

NodeId Planner::room_near(const Roadmap& roadmap, const ManifoldPose& pose, double within_m) const {
  const Eigen::Vector2d point = position(project(pose));
  const Cell middle = cell_of(point);
  const int reach = static_cast<int>(std::ceil(within_m / ground_cell_m));
  NodeId best = -1;
  double least = within_m;
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const Cell cell{middle.x + dx, middle.y + dy};
      const double distance = dx == 0 && dy == 0 ? 0 : (centre_of(cell) - point).norm();
      if (!(distance < least || (best < 0 && distance <= least))) continue;
      const NodeId node = roadmap.ground().find(cell, pose.patch);
      if (node < 0 || !roadmap.fits(node)) continue;
      best = node;
      least = distance;
    }
  }
  return best;
}

Path Planner::path(const PathQuestion& question) {
  const auto refuse = [](Refusal refusal) { return Path{refusal, {}, 0, {}}; };
  const bool tolerances = within(question.start_tolerance_m, 0, 2) && within(question.goal_tolerance_m, 0, 2);
  const Refusal wrong =
      first_of({check(question.footprint), check(*map_, question.from), check(*map_, question.to),
                tolerances ? Refusal::none : Refusal::bad_value});
  if (wrong != Refusal::none) return refuse(wrong);
  const IslandId island = map_->graph.island(question.from.patch);
  if (map_->graph.island(question.to.patch) != island) return refuse(Refusal::other_island);
  const std::shared_ptr<const Roadmap> roads = roadmap(island, question.footprint);
  if (!roads) return refuse(Refusal::no_ground);
  const NodeId start = room_near(*roads, question.from, question.start_tolerance_m);
  const NodeId goal = room_near(*roads, question.to, question.goal_tolerance_m);
  if (start < 0 || goal < 0) return refuse(why_not(island, question, Refusal::no_room));
  const auto route = find_route(*roads, start, goal, max_steps);
  if (!route)
    return refuse(
        why_not(island, question, roads->squares() > max_steps ? Refusal::too_long : Refusal::unreachable));
  return answer(*roads, question, pull(*roads, *route));
}

/// Whether it is for the zones that there is no way.
Refusal Planner::why_not(IslandId island, const PathQuestion& question, Refusal otherwise) {
  if (!zones_.any_keep_out(island)) return otherwise;
  const std::shared_ptr<const Roadmap> roads = roadmap(island, question.footprint, false);
  const NodeId start = room_near(*roads, question.from, question.start_tolerance_m);
  const NodeId goal = room_near(*roads, question.to, question.goal_tolerance_m);
  const bool reached = start >= 0 && goal >= 0 && find_route(*roads, start, goal, max_steps);
  return reached ? Refusal::kept_out : otherwise;
}

Path Planner::answer(const Roadmap& roadmap, const PathQuestion& question,
                     const std::vector<NodeId>& way) const {
  const Ground& ground = roadmap.ground();
  Path path{Refusal::none, {question.from}, 0, {0}};
  Eigen::Vector2d at = position(project(question.from));
  const IslandId island = map_->graph.island(question.from.patch);
  const auto go_to = [&](const Eigen::Vector2d& point, PatchId leader, double yaw) {
    path.length_m += (point - at).norm();
    path.max_speeds_m_s.push_back(zones_.max_speed_m_s(island, at, point, question.footprint.radius_m));
    at = point;
    path.poses.push_back(
        {leader, ominus({point.x(), point.y(), yaw}, map_->poses[static_cast<std::size_t>(leader.value)])});
  };
  for (std::size_t i = 0; i < way.size(); ++i) {
    // NOLINTNEXTLINE(performance-unnecessary-copy-initialization): `at` goes on as poses are added.
    const Eigen::Vector2d from = at, by = ground.centre(way[i]) - from;
    const double yaw = by.norm() > 0 ? std::atan2(by.y(), by.x()) : project(question.from).yaw;
    const int parts = i == 0 ? 1 : static_cast<int>(std::ceil(by.norm() / pose_distance_m));
    for (int part = 1; part < parts; ++part) {
      const Eigen::Vector2d point = from + by * (static_cast<double>(part) / parts);
      const auto node = roadmap.straight(way[i - 1], cell_of(point));
      if (node) go_to(point, ground.layer(*node).leader, yaw);
    }
    go_to(ground.centre(way[i]), ground.layer(way[i]).leader, yaw);
  }
  return path;
}

}  // namespace isthmus
