#include "scanmatch/features/beam_point.hpp"

#include <cmath>

namespace isthmus {

std::vector<BeamPoint> beam_points(const Scan& scan, const Laser& laser, const BeamNoise& noise) {
  std::vector<BeamPoint> points;
  points.reserve(scan.ranges_m.size());
  const std::size_t count = scan.ranges_m.size();
  const double along = std::pow(noise.range_sigma_m, 2) + std::pow(noise.surface_sigma_m, 2);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = scan.bearing_step_rad < 0 ? count - 1 - k : k;
    if (classify(scan.ranges_m[i], laser) != BeamKind::hit) continue;
    const double range = scan.ranges_m[i];
    const double bearing = scan.bearing0_rad + static_cast<double>(i) * scan.bearing_step_rad;
    const Eigen::Vector2d ray(std::cos(bearing), std::sin(bearing)), side(-ray.y(), ray.x());
    const double across = std::pow(range * noise.bearing_sigma_rad, 2);
    points.push_back({range * ray, along * ray * ray.transpose() + across * side * side.transpose(), range,
                      bearing, static_cast<int>(k)});
  }
  return points;
}

}  // namespace isthmus
