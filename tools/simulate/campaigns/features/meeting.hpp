#pragma once

#include "server/features/fusion/rendezvous.hpp"
#include "tools/simulate/plan/random.hpp"

namespace isthmus {

/// The alignment of two robots' maps by what both measure of one another, with the noise of Zhou and
/// Roumeliotis (2006), section IV: σ 0.02 m and 0.07 rad. `one_from_two`: the pose of the second robot in
/// the frame of the first.
RobotAlignment align_at_meeting(const Pose& one_from_two, Random random);

}  // namespace isthmus
