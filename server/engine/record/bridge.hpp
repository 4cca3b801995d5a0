#pragma once

#include <span>
#include <vector>

#include "patches/pose.hpp"
#include "server/engine/input/options/robot_options.hpp"

namespace isthmus {

/// Where a robot was between two places that are known, by the steps that its odometry tells from the one to
/// the other, of which there is one more than poses: each is bent by as much as such a step may err (eq. 5)
/// until they end where it was found again. Empty where steps do not err by so much: then it was carried, and
/// nobody knows where.
std::vector<Pose> bridge(const Pose& from, std::span<const Pose> steps, const Pose& to,
                         const OdometryNoiseOptions& options);

}  // namespace isthmus
