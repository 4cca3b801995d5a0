#pragma once

#include <optional>
#include <span>
#include <vector>

#include "relations/fit_problem.hpp"

namespace isthmus {

/// A start for a fit that needs no good poses, by two linear least-squares problems: first the (cos, sin) of
/// all yaws under ‖u_b − R̃ u_a‖², projected back to the circle; then the translations with the yaws fixed,
/// where Correspondences and RelativePose are linear exactly (chordal relaxation: Martinec and Pajdla, CVPR
/// 2007; Carlone et al., ICRA 2015). Range and Bearing relations and robust losses have no part in it; what
/// no relation determines stays as given. Nothing where a patch is free along a line only (a corridor without
/// odometry): the linear solution may then lie anywhere along it. `given` and the result are in the problem's
/// order; held poses return unchanged.
std::optional<std::vector<Pose>> chordal_poses(const FitProblem& problem, std::span<const Pose> given);

}  // namespace isthmus
