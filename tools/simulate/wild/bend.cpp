#include "tools/simulate/wild/bend.hpp"

#include <algorithm>
#include <cmath>

#include "patches/pose.hpp"
#include "tools/simulate/plan/random.hpp"

namespace isthmus {
namespace {

using Eigen::Vector2d;

constexpr double shrinks_by = 0.2;
constexpr double max_rad = 2.2;  // of one arc: the ends of a long building stay apart

// Along an arc, from its beginning.
Pose along(double length_m, double curvature_pm) {
  const double turn = length_m * curvature_pm;
  if (std::abs(turn) < 1e-9) return {length_m, 0, 0};
  return {std::sin(turn) / curvature_pm, (1 - std::cos(turn)) / curvature_pm, turn};
}

}  // namespace

Bend::Bend(const WildBuilding& building, const Vector2d& size, std::uint64_t seed)
    : middle_y_(0.5 * size.y()) {
  if (building.bend == WildBend::straight) return;
  Random random(seed, "wild bend");
  const double tightest_pm = 2 * shrinks_by / size.y();
  const int count = building.bend == WildBend::curved ? 1 : 1 + static_cast<int>(random.index(3));
  double sign = random.chance(0.5) ? 1 : -1;
  for (int i = 0; i < count; ++i) {
    const double room_m = size.x() / count;
    const double most = std::min({max_rad, building.bend_rad, tightest_pm * room_m});
    const double length_m = building.bend == WildBend::curved ? room_m : std::min(room_m, most / tightest_pm);
    const double from_x = i * room_m + random.uniform(0, room_m - length_m);
    arcs_.push_back({from_x, from_x + length_m, sign * most / length_m});
    sign = -sign;
  }
}

Vector2d Bend::operator()(const Vector2d& point) const {
  Pose middle;
  double x = 0;
  for (const Arc& arc : arcs_) {
    if (point.x() <= arc.from_x) break;
    middle = middle * along(arc.from_x - x, 0);
    x = std::min(point.x(), arc.to_x);
    middle = middle * along(x - arc.from_x, arc.curvature_pm);
  }
  middle = middle * along(point.x() - x, 0);
  return middle * Vector2d(0, point.y() - middle_y_);
}

std::vector<Vector2d> Bend::line(const Vector2d& from, const Vector2d& to, double spacing_m) const {
  const int pieces =
      arcs_.empty() ? 1 : std::max(1, static_cast<int>(std::ceil((to - from).norm() / spacing_m)));
  std::vector<Vector2d> points;
  for (int i = 1; i <= pieces; ++i) points.push_back((*this)(from + (to - from) * i / pieces));
  return points;
}

}  // namespace isthmus
