#pragma once

#include <span>
#include <vector>

#include "server/output/vector_plan/plan_options.hpp"
#include "server/output/vector_plan/plan_source.hpp"

namespace isthmus {

struct PlanPole {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double radius_m = 0;
  bool radius_known = false;
  double sigma_m = 0;  ///< of the centre, in the direction in which it is larger
  int views = 0;
};

/// Poles that enough views saw, and no fewer than looked through the place: somebody who stood there for a
/// while is none. Places are means over inverse covariances.
std::vector<PlanPole> fit_poles(const PlanSource& source, const PlanPoleOptions& options);

}  // namespace isthmus
