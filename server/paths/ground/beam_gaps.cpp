#include "server/paths/ground/beam_gaps.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/paths/ground/gaps.hpp"

namespace isthmus {
namespace {

/// Of the gap between two beams, the last so many steps after the first.
BeamGap gap_between(const Observation& seen, std::size_t first, std::size_t steps) {
  const Scan& scan = seen.scan;
  const std::size_t last = (first + steps) % scan.ranges_m.size();
  const double width_rad = static_cast<double>(steps) * std::abs(scan.bearing_step_rad);
  const double begin_rad = scan.bearing0_rad + static_cast<double>(first) * scan.bearing_step_rad;
  const double from_rad = scan.bearing_step_rad > 0 ? begin_rad : begin_rad - width_rad;
  const double rim_m = std::min({static_cast<double>(scan.ranges_m[first]),
                                 static_cast<double>(scan.ranges_m[last]), seen.star.reach_m()});
  return {from_rad, from_rad + width_rad, std::min(rim_m, 0.5 * max_gap_m / std::sin(0.5 * width_rad))};
}

}  // namespace

std::vector<BeamGap> find_beam_gaps(const Observation& seen) {
  const Scan& scan = seen.scan;
  const std::size_t beams = scan.ranges_m.size();
  const double step_rad = std::abs(scan.bearing_step_rad);
  const bool is_full_turn = static_cast<double>(beams) * step_rad > 2 * std::numbers::pi - 0.5 * step_rad;
  const auto is_hit = [&](std::size_t beam) {
    return classify(scan.ranges_m[beam % beams], seen.laser) == BeamKind::hit;
  };
  const auto tells_nothing = [&](std::size_t beam) {
    const float range_m = scan.ranges_m[beam % beams];
    return std::isnan(range_m) || classify(range_m, seen.laser) == BeamKind::no_return;
  };
  std::vector<BeamGap> gaps;
  for (std::size_t first = 0; first < beams; ++first) {
    if (!is_hit(first)) continue;
    const std::size_t most = is_full_turn ? beams - 1 : beams - 1 - first;
    std::size_t steps = 1;
    while (steps < most && tells_nothing(first + steps)) ++steps;
    const bool is_gap = steps > 1 && steps <= most && is_hit(first + steps) &&
                        static_cast<double>(steps) * step_rad < std::numbers::pi;
    if (is_gap) gaps.push_back(gap_between(seen, first, steps));
  }
  return gaps;
}

bool lies_in(const BeamGap& gap, const Laser& laser, const Eigen::Vector2d& point_robot) {
  const Eigen::Vector2d point = inverse(laser.robot_from_laser) * point_robot;
  if (point.norm() > gap.range_m) return false;
  const double middle_rad = 0.5 * (gap.from_rad + gap.to_rad);
  return std::abs(wrap_angle(std::atan2(point.y(), point.x()) - middle_rad)) <=
         0.5 * (gap.to_rad - gap.from_rad);
}

}  // namespace isthmus
