#pragma once

#include <Eigen/Core>

#include "patches/features/m_space.hpp"

namespace isthmus {

/// A line with an extent, and what is known of it: errors are a turn α (rad, counter-clockwise) and a shift ρ
/// (m) to the side `across`, at `middle`. Frame of an island; the observer has `from` on the right.
struct WallLine {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  Eigen::Vector2d along = Eigen::Vector2d::UnitX();          ///< unit
  double half_m = 0;                                         ///< half its extent
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< of (α, ρ)

  /// Away from the observer.
  Eigen::Vector2d across() const { return {along.y(), -along.x()}; }
  double along_m(const Eigen::Vector2d& point) const { return along.dot(point - middle); }
  double across_m(const Eigen::Vector2d& point) const { return across().dot(point - middle); }
  Eigen::Vector2d at(double along_m) const { return middle + along_m * along; }
};

/// The covariance of (α, ρ) with ρ taken at `along_m` from the middle.
Eigen::Matrix2d covariance_at(const WallLine& line, double along_m);

/// How two lines differ where they lie side by side, or in the middle of the gap between them: (α, ρ) of the
/// second in the frame of the first, with the covariance of the difference. Only for lines that are turned by
/// less than a quarter turn.
struct LineDifference {
  double turn_rad = 0;
  double step_m = 0;
  double gap_m = 0;  ///< along the first; negative where they overlap
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();
};
LineDifference difference(const WallLine& one, const WallLine& other);

/// The line that both measure, by maximum likelihood with independent errors, with the extent of both.
WallLine joined(const WallLine& one, const WallLine& other);

/// A segment as it was observed: its line and extent.
WallLine line_of(const ObservedFeature& segment);

}  // namespace isthmus
