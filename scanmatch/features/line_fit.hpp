#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "scanmatch/features/beam_point.hpp"

namespace isthmus {

/// A straight line fitted to points, in their frame. Its errors are a turn α (rad) and, at `centre`, a shift
/// ρ (m) to the side `across`; at the weighted centre of the points the two are independent.
struct Line {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  Eigen::Vector2d along = Eigen::Vector2d::UnitY();  ///< unit, from the first point to the last
  double alpha_variance = 0;                         ///< rad²
  double rho_variance = 0;                           ///< m²
  double chi_squared = 0;                            ///< of the residuals, n − 2 degrees of freedom
  double worst_sigmas = 0;                           ///< the largest residual, in its own σ

  Eigen::Vector2d across() const { return {along.y(), -along.x()}; }
  /// Where a point lies along it, from `centre`.
  double along_m(const Eigen::Vector2d& point) const { return along.dot(point - centre); }
  double across_m(const Eigen::Vector2d& point) const { return across().dot(point - centre); }
  Eigen::Vector2d at(double along_m) const { return centre + along_m * along; }
};

/// Total least squares: the line with the least sum of squared distances, each over the variance of its point
/// across the line; fitted anew with the variances that its direction gives. Nothing of fewer than two
/// points, or where all are one.
std::optional<Line> fit_line(std::span<const BeamPoint> points);

/// By how much a line's point at `along_m` moves across it with (α, ρ): its variance, m².
double across_variance(const Line& line, double along_m);

/// Where two lines meet; nothing where they are parallel within 1e-6 rad.
std::optional<Eigen::Vector2d> meeting_point(const Line& one, const Line& other);

}  // namespace isthmus
