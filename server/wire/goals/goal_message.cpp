#include "server/wire/goals/goal_message.hpp"

#include "server/wire/message/path_pose.hpp"

namespace isthmus {

goal_t goal_message(const MapCopy& map, const std::string& robot, const ManifoldPose& at,
                    const ExplorationOrder& order) {
  goal_t message{};
  message.id = order.number;
  message.robot = robot;
  message.reason = word(order.reason);
  message.island = map.graph.island(at.patch).value;
  message.pose = path_pose(map, at);
  message.has_goal = order.goal.has_value() ? 1 : 0;
  if (order.goal) {
    message.goal = path_pose(map, order.goal->viewpoint);
    message.size_m = order.goal->size_m;
    message.gain_m2 = order.goal->gain_m2;
  }
  message.at_goal = order.is_last ? 1 : 0;
  for (const ManifoldPose& pose : order.path) message.poses.push_back(path_pose(map, pose));
  message.nposes = static_cast<std::int32_t>(message.poses.size());
  return message;
}

}  // namespace isthmus
