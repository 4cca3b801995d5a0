#include "patches/surface.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace isthmus {
namespace {

constexpr double max_off_m = 0.1;  // of an end from the other's line: laser noise, and how far lines are sure
constexpr double max_gap_m = 4;    // beyond which nothing is said of what is between: bounds the work

bool on_one_surface(const ScanPoint& a, const ScanPoint& b) {
  return a.has_normal() && b.has_normal() && a.normal.dot(b.normal) > 0 &&
         std::abs(a.distance_from_line_m(b.position)) <= max_off_m &&
         std::abs(b.distance_from_line_m(a.position)) <= max_off_m;
}

}  // namespace

std::vector<SurfacePoint> between_beams(std::span<const ScanPoint> points, double step_m) {
  int least = std::numeric_limits<int>::max();  // between beams: some scans are thinned
  for (std::size_t i = 1; i < points.size(); ++i)
    least = std::min(least, points[i].beam - points[i - 1].beam);
  std::vector<SurfacePoint> between;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const ScanPoint& a = points[i - 1];
    const ScanPoint& b = points[i];
    const Eigen::Vector2d step = b.position - a.position;
    const double gap_m = step.norm();
    if (!(gap_m > step_m && gap_m <= max_gap_m) || b.beam - a.beam > least || !on_one_surface(a, b)) continue;
    const int parts = static_cast<int>(std::ceil(gap_m / step_m));
    for (int k = 1; k < parts; ++k) {
      const double share = static_cast<double>(k) / parts;
      between.push_back({a.position + share * step, share < 0.5 ? i - 1 : i});
    }
  }
  return between;
}

}  // namespace isthmus
