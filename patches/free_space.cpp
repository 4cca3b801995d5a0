#include <algorithm>
#include <cmath>
#include <numbers>

#include "patches/polysolid.hpp"

namespace isthmus {
namespace {

using Eigen::Vector2d;

// The beams of a scan by rising bearing.
struct Fan {
  double bearing0_rad = 0;
  double step_rad = 0;
  bool closed = false;         // a full turn: the last beam and the first are neighbours
  std::vector<double> free_m;  // free range of each beam; 0 where it opens nothing
};

double free_range_m(float range_m, const Laser& laser, const FreeSpaceOptions& options) {
  const BeamKind kind = classify(range_m, laser);
  if (kind == BeamKind::ignored) return 0;
  const double seen_m = kind == BeamKind::hit ? static_cast<double>(range_m) : options.no_return_range_m;
  const double free_m = std::min({seen_m, options.max_range_m, 0.5 * max_coordinate_m});
  return free_m >= options.outline.min_free_m ? free_m : 0;
}

bool is_usable(const Scan& scan, const Laser& laser, const FreeSpaceOptions& options) {
  const double step_rad = std::abs(scan.bearing_step_rad);
  return std::isfinite(scan.bearing0_rad) && step_rad > 0 && step_rad < std::numbers::pi &&
         is_finite(laser.robot_from_laser) && options.max_range_m > 0 &&
         !std::isnan(options.no_return_range_m);
}

Fan fan_of(const Scan& scan, const Laser& laser, const FreeSpaceOptions& options) {
  Fan fan;
  fan.step_rad = std::abs(scan.bearing_step_rad);
  // Beams beyond a full turn look where others have looked.
  const double turn_beams = std::floor(2 * std::numbers::pi / fan.step_rad + 1e-6);
  const std::size_t n =
      static_cast<std::size_t>(std::min(static_cast<double>(scan.ranges_m.size()), turn_beams));
  fan.free_m.resize(n);
  std::transform(scan.ranges_m.begin(), scan.ranges_m.begin() + static_cast<std::ptrdiff_t>(n),
                 fan.free_m.begin(), [&](float range_m) { return free_range_m(range_m, laser, options); });
  fan.bearing0_rad = scan.bearing0_rad;
  if (scan.bearing_step_rad < 0 && n > 0) {
    std::reverse(fan.free_m.begin(), fan.free_m.end());
    fan.bearing0_rad += static_cast<double>(n - 1) * scan.bearing_step_rad;
  }
  const double gap_rad = 2 * std::numbers::pi - (static_cast<double>(n) - 1) * fan.step_rad;
  fan.closed = n >= 3 && gap_rad < std::min(options.outline.closing_beams * fan.step_rad, std::numbers::pi);
  return fan;
}

// Neighbouring beams that all open something; indices run past the last beam to the first in a closed fan.
struct Run {
  std::size_t first;
  std::size_t count;
};

std::vector<Run> runs_of(const Fan& fan) {
  const std::size_t n = fan.free_m.size();
  std::size_t start = 0;
  if (fan.closed) {
    const auto gap = std::find(fan.free_m.begin(), fan.free_m.end(), 0.0);
    if (gap == fan.free_m.end()) return {{0, n}};
    start = static_cast<std::size_t>(gap - fan.free_m.begin());
  }
  std::vector<Run> runs;
  for (std::size_t i = start; i < start + n; ++i) {
    if (fan.free_m[i % n] == 0) continue;
    if (!runs.empty() && runs.back().first + runs.back().count == i) {
      ++runs.back().count;
    } else {
      runs.push_back({i, 1});
    }
  }
  return runs;
}

// A star polygon by rising bearing, which simplifying leaves simple as long as neighbours in it are less than
// half a turn apart.
Ring ring_of(const Fan& fan, const Run& run, const Pose& robot_from_laser, double tolerance_m) {
  const std::size_t n = fan.free_m.size();
  std::vector<Vector2d> ends(run.count);
  for (std::size_t k = 0; k < run.count; ++k) {
    const double bearing_rad =
        robot_from_laser.yaw + fan.bearing0_rad + static_cast<double>(run.first + k) * fan.step_rad;
    const double free_m = fan.free_m[(run.first + k) % n];
    ends[k] = {robot_from_laser.x + free_m * std::cos(bearing_rad),
               robot_from_laser.y + free_m * std::sin(bearing_rad)};
  }
  const bool full_turn = fan.closed && run.count == n;
  if (full_turn) ends.push_back(ends.front());

  constexpr double max_gap_beams = 512;
  const double gap = std::min(max_gap_beams, 0.5 * std::numbers::pi / fan.step_rad);
  Ring ring;
  if (!full_turn) ring.push_back(position(robot_from_laser));
  for (const std::size_t k : simplify_chain(ends, tolerance_m, static_cast<std::size_t>(gap))) {
    ring.push_back(ends[k]);
  }
  if (full_turn) ring.pop_back();
  return ring;
}

}  // namespace

Polysolid free_space_of(const Scan& scan, const Laser& laser, const FreeSpaceOptions& options) {
  if (!is_usable(scan, laser, options)) return {};
  const double tolerance_m = std::max(0.0, options.outline.simplify_tolerance_m);
  const Fan fan = fan_of(scan, laser, options);
  std::vector<PolygonWithHoles> polygons;
  bool sound = true;
  for (const Run& run : runs_of(fan)) {
    if (run.count < 2) continue;
    Ring ring = ring_of(fan, run, laser.robot_from_laser, tolerance_m);
    if (!(signed_area_m2(ring) >= min_ring_area_m2)) continue;
    sound = sound && is_simple(ring);
    polygons.push_back({std::move(ring), {}});
  }
  return sound ? Polysolid::of_sound(std::move(polygons)) : Polysolid(std::move(polygons));
}

}  // namespace isthmus
