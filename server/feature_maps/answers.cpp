// What a FeatureMapper tells while it maps.

#include <algorithm>

#include "server/feature_maps/feature_mapper.hpp"

namespace isthmus {

std::vector<RobotPose> FeatureMapper::take_answers() {
  std::vector<RobotPose> answers;
  for (const std::string& name : std::exchange(moved_, {})) {
    const FeatureRobot& robot = robots_.at(name);
    if (robot.journey < 0 || journey(robot).rows.empty()) continue;
    const Journey& own = journey(robot);
    const Team& team = teams_[static_cast<std::size_t>(own.team)];
    RobotPose pose;
    pose.robot = name;
    pose.utime = own.rows.back().utime;
    pose.island = {*std::min_element(team.journeys.begin(), team.journeys.end())};
    pose.map_from_robot = team.filter.state().robots[static_cast<std::size_t>(own.member)].map_from_robot;
    pose.pose.patch_from_object = pose.map_from_robot;
    pose.covariance = pose_covariance(team.filter.state(), own.member);
    pose.map_from_odom = pose.map_from_robot * inverse(robot.odom_from_last);
    pose.matched = robot.matched;
    answers.push_back(std::move(pose));
  }
  return answers;
}

std::optional<FusionState> FeatureMapper::state_of_fusion(std::int32_t id) const {
  const auto found = fusions_.find(id);
  if (found == fusions_.end()) return std::nullopt;
  return found->second.state;
}

}  // namespace isthmus
