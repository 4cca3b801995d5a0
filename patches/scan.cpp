#include "patches/scan.hpp"

#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

// Sums over a run of points, from which a line is fitted.
struct Moments {
  int n = 0;
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double xx = 0, xy = 0, yy = 0;

  void add(const Eigen::Vector2d& d) {
    ++n;
    sum += d;
    xx += d.x() * d.x();
    xy += d.x() * d.y();
    yy += d.y() * d.y();
  }
};

// Unit normal of the line through the points (up to sign), or zero where they are not flat or too short.
Eigen::Vector2d line_normal(const Moments& m, const NormalOptions& options) {
  if (m.n < options.min_points) return Eigen::Vector2d::Zero();
  const Eigen::Vector2d mean = m.sum / m.n;
  const double xx = m.xx / m.n - mean.x() * mean.x();
  const double yy = m.yy / m.n - mean.y() * mean.y();
  const double xy = m.xy / m.n - mean.x() * mean.y();
  const double half_trace = 0.5 * (xx + yy);
  const double root = std::hypot(0.5 * (xx - yy), xy);
  const double across = std::max(0.0, half_trace - root);
  const double along = half_trace + root;
  if (across > options.max_flatness_m * options.max_flatness_m || along < options.min_elongation * across ||
      along < 1e-6) {
    return Eigen::Vector2d::Zero();
  }
  const double line_yaw = 0.5 * std::atan2(2 * xy, xx - yy);
  return {-std::sin(line_yaw), std::cos(line_yaw)};
}

}  // namespace

BeamKind classify(float range_m, const Laser& laser) {
  if (std::isnan(range_m) || range_m <= 0 || range_m < laser.range_min_m) return BeamKind::ignored;
  // Of what is sent as the largest range, 5.6 m as a float is less than as a double.
  return range_m >= static_cast<float>(laser.range_max_m) ? BeamKind::no_return : BeamKind::hit;
}

std::vector<ScanPoint> to_points(const Scan& scan, const Laser& laser, const NormalOptions& options) {
  std::vector<ScanPoint> points;
  std::vector<double> reach;  // how far neighbours may lie: far beams are far apart
  points.reserve(scan.ranges_m.size());
  reach.reserve(scan.ranges_m.size());
  for (std::size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const float range_m = scan.ranges_m[i];
    if (classify(range_m, laser) != BeamKind::hit) continue;
    const double bearing = scan.bearing0_rad + static_cast<double>(i) * scan.bearing_step_rad;
    const Eigen::Vector2d end(range_m * std::cos(bearing), range_m * std::sin(bearing));
    points.push_back({laser.robot_from_laser * end, Eigen::Vector2d::Zero(), static_cast<std::int32_t>(i)});
    reach.push_back(options.reach_beams * range_m * std::abs(scan.bearing_step_rad));
  }
  const Eigen::Vector2d eye(laser.robot_from_laser.x, laser.robot_from_laser.y);
  const int n = static_cast<int>(points.size());
  for (int i = 0; i < n; ++i) {
    const auto at = [&](int k) -> const Eigen::Vector2d& {
      return points[static_cast<std::size_t>(k)].position;
    };
    const double spread = reach[static_cast<std::size_t>(i)];
    const double half_width = std::max(options.half_width_m, spread);
    const double max_jump = std::max(options.max_jump_m, spread);
    Moments moments;
    moments.add(Eigen::Vector2d::Zero());
    for (const int step : {-1, 1}) {
      for (int k = i + step; k >= 0 && k < n; k += step) {
        const Eigen::Vector2d offset = at(k) - at(i);
        if ((at(k) - at(k - step)).norm() > max_jump || offset.norm() > half_width) break;
        moments.add(offset);
      }
    }
    const Eigen::Vector2d normal = line_normal(moments, options);
    points[static_cast<std::size_t>(i)].normal =
        normal.dot(eye - at(i)) < 0 ? Eigen::Vector2d(-normal) : normal;
  }
  return points;
}

}  // namespace isthmus
