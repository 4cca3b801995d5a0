#pragma once

#include "isthmus/path_pose_t.hpp"
#include "server/engine/record/map_copy.hpp"

namespace isthmus {

/// As x, y and yaw.
void set_pose(double (&components)[3], const Pose& pose);

/// A place of a path for the wire, without a speed. Its patch must be on the map.
path_pose_t path_pose(const MapCopy& map, const ManifoldPose& pose);

}  // namespace isthmus
