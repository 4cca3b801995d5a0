#pragma once

#include <vector>

#include "server/engine/input/drop_reason.hpp"
#include "server/engine/robot/robot_pose.hpp"

namespace isthmus {

/// What became of an event.
struct Outcome {
  DropReason drop_reason = DropReason::none;  ///< none: accepted
  std::vector<RobotPose> poses;  ///< scans answered by this event (a scan may wait for its odometry)
};

}  // namespace isthmus
