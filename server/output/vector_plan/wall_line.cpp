#include "server/output/vector_plan/wall_line.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

/// (α, ρ) a distance `along_m` on: a turn shifts what lies ahead to the observer's side.
Eigen::Matrix2d moved(const Eigen::Matrix2d& covariance, double along_m) {
  Eigen::Matrix2d by;
  by << 1, 0, -along_m, 1;
  return by * covariance * by.transpose();
}

/// The second line as the first one's frame has it.
struct Seen {
  double turn_rad = 0;
  double along_m = 0;   ///< of its middle
  double across_m = 0;  ///< of its middle
  double low_m = 0;     ///< extent along the first
  double high_m = 0;
};

Seen seen_from(const WallLine& one, const WallLine& other) {
  Seen seen;
  const double sine = -one.across().dot(other.along);
  seen.turn_rad = std::atan2(sine, one.along.dot(other.along));
  seen.along_m = one.along_m(other.middle);
  seen.across_m = one.across_m(other.middle);
  const double half = other.half_m * one.along.dot(other.along);
  seen.low_m = seen.along_m - half;
  seen.high_m = seen.along_m + half;
  return seen;
}

}  // namespace

Eigen::Matrix2d covariance_at(const WallLine& line, double along_m) {
  return moved(line.covariance, along_m);
}

LineDifference difference(const WallLine& one, const WallLine& other) {
  const Seen seen = seen_from(one, other);
  const double low = std::max(-one.half_m, seen.low_m), high = std::min(one.half_m, seen.high_m);
  const double at = 0.5 * (low + high);
  LineDifference result;
  result.turn_rad = seen.turn_rad;
  result.step_m = seen.across_m - (at - seen.along_m) * std::tan(seen.turn_rad);
  result.gap_m = low - high;
  result.covariance = moved(one.covariance, at) + moved(other.covariance, at - seen.along_m);
  return result;
}

WallLine joined(const WallLine& one, const WallLine& other) {
  const Seen seen = seen_from(one, other);
  const Eigen::Vector2d offset(seen.turn_rad, seen.across_m + seen.along_m * std::tan(seen.turn_rad));
  const Eigen::Matrix2d other_information = moved(other.covariance, -seen.along_m).inverse();
  WallLine both;
  both.covariance = (one.covariance.inverse() + other_information).inverse();
  const Eigen::Vector2d delta = both.covariance * other_information * offset;
  both.along = (std::cos(delta.x()) * one.along - std::sin(delta.x()) * one.across()).normalized();
  both.middle = one.middle + delta.y() * one.across();
  double low = 1e300, high = -1e300;
  for (const WallLine* line : {&one, &other}) {
    for (const double end : {-line->half_m, line->half_m}) {
      low = std::min(low, both.along_m(line->at(end)));
      high = std::max(high, both.along_m(line->at(end)));
    }
  }
  both.half_m = 0.5 * (high - low);
  both.covariance = moved(both.covariance, 0.5 * (low + high));
  both.covariance = (0.5 * (both.covariance + both.covariance.transpose())).eval();
  both.middle = both.at(0.5 * (low + high));
  return both;
}

WallLine line_of(const ObservedFeature& segment) {
  WallLine line;
  line.middle = 0.5 * (segment.feature.a + segment.feature.b);
  line.along = along(segment.feature);
  line.half_m = 0.5 * length_m(segment.feature);
  line.covariance = segment.covariance.topLeftCorner<2, 2>();
  return line;
}

}  // namespace isthmus
