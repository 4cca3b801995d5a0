#pragma once

#include <cstdint>
#include <string>

#include "patches/pose.hpp"

namespace isthmus {

/// A row of a trajectory as TUM's RGB-D benchmark has it: `timestamp tx ty tz qx qy qz qw`, in seconds and
/// metres.
std::string tum_line(std::int64_t utime, const Pose& map_from_robot);

}  // namespace isthmus
