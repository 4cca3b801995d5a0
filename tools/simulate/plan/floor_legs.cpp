#include "tools/simulate/plan/floor_legs.hpp"

#include <cmath>

namespace isthmus {

std::vector<Eigen::Vector2d> waypoints_of(const std::vector<FloorLeg>& legs) {
  std::vector<Eigen::Vector2d> points;
  const auto add = [&](const Eigen::Vector2d& point) {
    if (points.empty() || (point - points.back()).norm() > 0.05) points.push_back(point);
  };
  for (std::size_t i = 0; i + 1 < legs.size(); ++i) {
    const FloorLeg &leg = legs[i], &next = legs[i + 1];
    const double turn = leg.direction().dot(next.direction());
    if (std::abs(turn) < 0.5) {
      add(leg.to + leg.offset() + next.offset());
    } else if (turn < 0) {
      add(leg.to + leg.offset());
      add(leg.to + next.offset());
    }
  }
  add(legs.back().to + legs.back().offset());
  return points;
}

}  // namespace isthmus
