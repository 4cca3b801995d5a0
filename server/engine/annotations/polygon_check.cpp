#include "server/engine/annotations/polygon_check.hpp"

#include <algorithm>
#include <cstddef>

namespace isthmus {
namespace {

using Point = Eigen::Vector2d;

/// Twice the area of the triangle: positive where c is to the left of a -> b.
double side_of(const Point& a, const Point& b, const Point& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

/// Of a point on the line through a and b.
bool is_between(const Point& a, const Point& b, const Point& point) {
  return std::min(a.x(), b.x()) <= point.x() && point.x() <= std::max(a.x(), b.x()) &&
         std::min(a.y(), b.y()) <= point.y() && point.y() <= std::max(a.y(), b.y());
}

/// Whether two closed segments have a point in common.
bool share_a_point(const Point& a, const Point& b, const Point& c, const Point& d) {
  const double to_c = side_of(a, b, c), to_d = side_of(a, b, d);
  const double to_a = side_of(c, d, a), to_b = side_of(c, d, b);
  if (((to_c > 0) != (to_d > 0)) && ((to_a > 0) != (to_b > 0)) && to_c != 0 && to_d != 0 && to_a != 0 &&
      to_b != 0)
    return true;
  return (to_c == 0 && is_between(a, b, c)) || (to_d == 0 && is_between(a, b, d)) ||
         (to_a == 0 && is_between(c, d, a)) || (to_b == 0 && is_between(c, d, b));
}

/// Whether a side goes back over the one before it: a -> b -> c with c on the way back.
bool turns_back(const Point& a, const Point& b, const Point& c) {
  return side_of(a, b, c) == 0 && (a - b).dot(c - b) >= 0;
}

}  // namespace

double signed_area_m2(std::span<const Point> ring) {
  double twice = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point &a = ring[i], &b = ring[(i + 1) % ring.size()];
    // From the first corner on, so that what is far from the origin loses no digits.
    twice += side_of(ring[0], a, b);
  }
  return 0.5 * twice;
}

bool is_simple(std::span<const Point> ring) {
  const std::size_t n = ring.size();
  if (n < 3) return false;
  const auto at = [&](std::size_t i) -> const Point& { return ring[i % n]; };
  for (std::size_t i = 0; i < n; ++i) {
    if (turns_back(at(i), at(i + 1), at(i + 2))) return false;
    for (std::size_t j = i + 2; j < n; ++j) {
      const bool neighbours = i == 0 && j + 1 == n;
      if (!neighbours && share_a_point(at(i), at(i + 1), at(j), at(j + 1))) return false;
    }
  }
  return true;
}

bool is_inside(std::span<const Point> ring, const Point& point) {
  int winding = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point &a = ring[i], &b = ring[(i + 1) % ring.size()];
    if ((a.y() <= point.y()) == (b.y() <= point.y())) continue;
    const double side = side_of(a, b, point);
    if (a.y() <= point.y() && side > 0) ++winding;
    if (a.y() > point.y() && side < 0) --winding;
  }
  return winding != 0;
}

}  // namespace isthmus
