#include "server/wire/page/texts/exploration_text.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "server/wire/page/texts/drawn_points.hpp"

namespace isthmus {
namespace {

using Json = nlohmann::json;

/// What of a way lies on the island of the robot that drives it.
Json way_json(const std::vector<path_pose_t>& way, IslandId island, const ShownMap& shown) {
  Json points = Json::array();
  for (const ManifoldPose& pose : thinned(way)) {
    if (!shown.has(pose.patch) || shown.island(pose.patch) != island) continue;
    const Pose at = shown.project(pose);
    points.push_back({to_centimetres(at.x), to_centimetres(at.y)});
  }
  return points;
}

Json goal_json(const goal_t& told, const ShownMap& shown) {
  const IslandId island = shown.island(PatchId{told.pose.patch});
  Json goal = nullptr;
  const ManifoldPose viewpoint = manifold_pose(told.goal);
  if (told.has_goal && shown.has(viewpoint.patch) && shown.island(viewpoint.patch) == island) {
    const Pose at = shown.project(viewpoint);
    goal = {to_centimetres(at.x), to_centimetres(at.y), to_centimetres(at.yaw)};
  }
  return {{"robot", told.robot},
          {"reason", told.reason},
          {"island", island.value},
          {"goal", std::move(goal)},
          {"gain", to_centimetres(told.gain_m2)},
          {"way", way_json(told.poses, island, shown)}};
}

}  // namespace

std::string exploration_text(const TeamGoals& team, const ShownMap& shown) {
  Json goals = Json::array(), frontiers = Json::array();
  for (const goal_t& told : team.goals)
    if (shown.has(PatchId{told.pose.patch})) goals.push_back(goal_json(told, shown));
  for (const ExplorationGoal& frontier : team.frontiers) {
    if (!shown.has(frontier.viewpoint.patch)) continue;
    const Pose at = shown.project(frontier.viewpoint);
    frontiers.push_back({shown.island(frontier.viewpoint.patch).value, to_centimetres(at.x),
                         to_centimetres(at.y), to_centimetres(at.yaw), to_centimetres(frontier.gain_m2)});
  }
  const Json all = {{"goals", std::move(goals)}, {"frontiers", std::move(frontiers)}};
  return all.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace isthmus
