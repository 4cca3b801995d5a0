#pragma once

#include <optional>
#include <span>

#include "scanmatch/features/beam_point.hpp"

namespace isthmus {

/// A circle seen from outside, in the points' frame; metres.
struct Circle {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double radius_m = 0;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< of (x, y, r), m²
  double chi_squared = 0;                                    ///< of the residuals, n − 3 degrees of freedom
};

/// Least squares of the points' distances from the circle, each over the variance of its point across it:
/// Gauss and Newton's method from the circle that has the points' width. Nothing of fewer than four points,
/// where it does not settle, or where the radius leaves (0, max_m).
std::optional<Circle> fit_circle(std::span<const BeamPoint> points, double max_m);

}  // namespace isthmus
