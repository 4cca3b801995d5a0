#include "server/wire/message/path_pose.hpp"

namespace isthmus {
void set_pose(double (&components)[3], const Pose& pose) {
  components[0] = pose.x;
  components[1] = pose.y;
  components[2] = pose.yaw;
}

path_pose_t path_pose(const MapCopy& map, const ManifoldPose& pose) {
  path_pose_t message{};
  message.patch = pose.patch.value;
  set_pose(message.patch_from_robot, pose.patch_from_object);
  set_pose(message.map_from_robot,
           map.poses[static_cast<std::size_t>(pose.patch.value)] * pose.patch_from_object);
  return message;
}

}  // namespace isthmus
