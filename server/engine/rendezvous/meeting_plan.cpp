#include "server/engine/rendezvous/meeting_plan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace isthmus {
namespace {

// A patch of an island and its pose in the plane of the hypothesis' first island.
struct Placed {
  const Patch* patch = nullptr;
  Pose plane_from_patch;
};

// The robot that stands on a patch's island now: who saw the patch, or else another.
std::string robot_on_island(const Map& map, const std::map<std::string, Robot>& robots, PatchId patch) {
  const IslandId island = map.graph().island(patch);
  const auto is_there = [&](const Robot& robot) {
    return robot.declared && robot.place && map.graph().island(robot.place->pose.patch) == island;
  };
  const auto owner = robots.find(map.manifold().patch(patch).robot);
  if (owner != robots.end() && is_there(owner->second)) return owner->first;
  for (const auto& [name, robot] : robots)
    if (is_there(robot)) return name;
  return "";
}

// The patches of an island near one of it, by distance from there.
std::vector<Placed> patches_near(const Map& map, PatchId centre, const Pose& plane_from_map,
                                 const MeetingOptions& options) {
  const Pose& from = map.manifold().pose(centre);
  std::vector<std::pair<double, PatchId>> near;
  for (const PatchId id : map.graph().patches_of(map.graph().island(centre))) {
    const Pose& pose = map.manifold().pose(id);
    const double distance_m = std::hypot(pose.x - from.x, pose.y - from.y);
    if (distance_m <= options.search_m && map.manifold().patch(id).tag < 0) near.emplace_back(distance_m, id);
  }
  std::ranges::sort(near);
  std::vector<Placed> placed;
  for (const auto& [distance_m, id] : near)
    placed.push_back({&map.manifold().patch(id), plane_from_map * map.manifold().pose(id)});
  return placed;
}

// Whether a patch knows a point for free: it lies in what its laser saw, so far in front of what it met, or
// where the robot stood.
bool is_free(const Placed& placed, const Eigen::Vector2d& point, double margin_m) {
  const Eigen::Vector2d seen = inverse(placed.plane_from_patch) * point;
  return seen.norm() < Manifold::footprint_m - margin_m || placed.patch->star.depth_m(seen) > margin_m;
}

const Placed* patch_that_knows_free(const std::vector<Placed>& island, const Eigen::Vector2d& point,
                                    double margin_m) {
  const auto found =
      std::ranges::find_if(island, [&](const Placed& placed) { return is_free(placed, point, margin_m); });
  return found == island.end() ? nullptr : &*found;
}

// Whether an island knows a disc for free: its middle and its rim.
bool is_roomy(const std::vector<Placed>& island, const Eigen::Vector2d& centre, double radius_m,
              int bearings) {
  if (patch_that_knows_free(island, centre, 0) == nullptr) return false;
  for (int k = 0; k < bearings; ++k) {
    const double bearing = k * 2 * std::numbers::pi / bearings;
    const Eigen::Vector2d rim = centre + radius_m * Eigen::Vector2d(std::cos(bearing), std::sin(bearing));
    if (patch_that_knows_free(island, rim, 0) == nullptr) return false;
  }
  return true;
}

bool is_clear_line(const std::vector<Placed>& island, const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                   const MeetingOptions& options) {
  const int steps = std::max(1, static_cast<int>((to - from).norm() / options.sight_margin_m));
  for (int k = 0; k <= steps; ++k) {
    const Eigen::Vector2d at = from + static_cast<double>(k) / steps * (to - from);
    if (patch_that_knows_free(island, at, options.sight_margin_m) == nullptr) return false;
  }
  return true;
}

ManifoldPose facing(const Placed& on, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const Eigen::Vector2d way = to - from;
  const Pose plane_from_meeting{from.x(), from.y(), std::atan2(way.y(), way.x())};
  return {on.patch->id, ominus(plane_from_meeting, on.plane_from_patch)};
}

}  // namespace

bool could_see_one_another(const Robot& a, const Robot& b) {
  return a.declaration.barcode >= 0 && b.declaration.barcode >= 0;
}

Pose first_map_from_second_map(const Map& map, const UndecidedHypothesis& hypothesis) {
  return map.manifold().pose(hypothesis.first) * hypothesis.first_from_second *
         inverse(map.manifold().pose(hypothesis.second));
}

std::optional<MeetingPlan> plan_meeting(const Map& map, const std::map<std::string, Robot>& robots,
                                        const UndecidedHypothesis& hypothesis,
                                        const MeetingOptions& options) {
  const IslandId first_island = map.graph().island(hypothesis.first),
                 second_island = map.graph().island(hypothesis.second);
  if (first_island == second_island) return std::nullopt;
  const std::string a = robot_on_island(map, robots, hypothesis.first),
                    b = robot_on_island(map, robots, hypothesis.second);
  if (a.empty() || b.empty() || !could_see_one_another(robots.at(a), robots.at(b))) return std::nullopt;

  const std::vector<Placed> first = patches_near(map, hypothesis.first, Pose{}, options),
                            second = patches_near(map, hypothesis.second,
                                                  first_map_from_second_map(map, hypothesis), options);
  const double room_m = robots.at(b).declaration.footprint_radius_m + options.wall_margin_m;
  // The first robot stands where one stood when it took a scan, the second somewhere around.
  for (const Placed& at : first) {
    const Eigen::Vector2d place_a = position(at.plane_from_patch);
    for (const double distance_m : {options.distance_m, options.distance_m - options.distance_step_m,
                                    options.distance_m + options.distance_step_m}) {
      for (int k = 0; k < options.bearings; ++k) {
        const double bearing = at.plane_from_patch.yaw + k * 2 * std::numbers::pi / options.bearings;
        const Eigen::Vector2d place_b =
            place_a + distance_m * Eigen::Vector2d(std::cos(bearing), std::sin(bearing));
        const Placed* on = patch_that_knows_free(second, place_b, 0);
        if (on == nullptr || !is_roomy(second, place_b, room_m, options.bearings) ||
            !is_clear_line(first, place_a, place_b, options) ||
            !is_clear_line(second, place_b, place_a, options))
          continue;
        return MeetingPlan{hypothesis, {a, facing(at, place_a, place_b)}, {b, facing(*on, place_b, place_a)}};
      }
    }
  }
  return std::nullopt;
}

}  // namespace isthmus
