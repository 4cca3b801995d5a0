#include "patches/ring.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "patches/segment.hpp"

namespace isthmus {
namespace {

using Eigen::Vector2d;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// Twice the signed area of (a, b, c), or exactly 0 where rounding leaves its sign open (Shewchuk, Adaptive
// Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates, 1997, bound A of orient2d).
double orientation(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  const double left = (a.x() - c.x()) * (b.y() - c.y());
  const double right = (a.y() - c.y()) * (b.x() - c.x());
  const double area = left - right;
  constexpr double bound = 3.3306690738754716e-16;
  return std::abs(area) > bound * (std::abs(left) + std::abs(right)) ? area : 0.0;
}

Vector2d rounded(const Vector2d& point) {
  constexpr double per_metre = 1 << 30;
  return (point * per_metre).array().round() / per_metre;
}

bool in_bounds(const Vector2d& point) {
  return std::abs(point.x()) <= max_coordinate_m && std::abs(point.y()) <= max_coordinate_m;
}

// Where two edges of a ring meet other than as neighbours do: edge i runs from point i to point i + 1.
struct Conflict {
  std::size_t i;
  std::size_t j;
  Vector2d at;
};

// Neighbouring edges, the second beginning where the first ends, conflict when one folds back on the other.
std::optional<Vector2d> fold(const Vector2d& before, const Vector2d& tip, const Vector2d& after) {
  const Vector2d back = before - tip;
  const Vector2d on = after - tip;
  if (orientation(before, tip, after) != 0 || back.dot(on) < 0) return std::nullopt;
  return back.squaredNorm() <= on.squaredNorm() ? before : after;
}

std::optional<Vector2d> conflict_point(const Ring& ring, std::size_t i, std::size_t j) {
  const std::size_t n = ring.size();
  if (j == i + 1) return fold(ring[i], ring[j], ring[(j + 1) % n]);
  if (i == 0 && j == n - 1) return fold(ring[j], ring[0], ring[1]);
  const Meeting meeting = meet(ring[i], ring[i + 1], ring[j], ring[(j + 1) % n]);
  if (meeting.kind == Meeting::apart) return std::nullopt;
  return meeting.at;
}

struct EdgeBox {
  double min_x, max_x, min_y, max_y;
  std::size_t edge;
};

std::vector<EdgeBox> edges_by_min_x(const Ring& ring) {
  std::vector<EdgeBox> boxes(ring.size());
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vector2d& a = ring[i];
    const Vector2d& b = ring[i + 1 < ring.size() ? i + 1 : 0];
    boxes[i] = {std::min(a.x(), b.x()), std::max(a.x(), b.x()), std::min(a.y(), b.y()),
                std::max(a.y(), b.y()), i};
  }
  std::sort(boxes.begin(), boxes.end(), [](const EdgeBox& a, const EdgeBox& b) {
    return a.min_x < b.min_x || (a.min_x == b.min_x && a.edge < b.edge);
  });
  return boxes;
}

std::optional<Conflict> find_conflict(const Ring& ring) {
  if (ring.size() < 3) return std::nullopt;
  const std::vector<EdgeBox> boxes = edges_by_min_x(ring);
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    for (std::size_t m = k + 1; m < boxes.size() && boxes[m].min_x <= boxes[k].max_x; ++m) {
      if (boxes[m].min_y > boxes[k].max_y || boxes[k].min_y > boxes[m].max_y) continue;
      const auto [i, j] = std::minmax(boxes[k].edge, boxes[m].edge);
      if (const auto at = conflict_point(ring, i, j)) return Conflict{i, j, *at};
    }
  }
  return std::nullopt;
}

void append_new(Ring& ring, const Vector2d& point) {
  if (ring.empty() || ring.back() != point) ring.push_back(point);
}

Ring closed_up(Ring ring) {
  while (ring.size() > 1 && ring.back() == ring.front()) ring.pop_back();
  return ring;
}

Ring cleaned(const Ring& ring) {
  Ring clean;
  clean.reserve(ring.size());
  for (const Vector2d& point : ring) {
    if (in_bounds(point)) append_new(clean, rounded(point));
  }
  return closed_up(std::move(clean));
}

// The two loops into which a ring falls where it meets itself. Their interiors, combined by exclusive or, are
// the interior of the ring by the even-odd rule.
std::pair<Ring, Ring> parted(const Ring& ring, const Conflict& conflict) {
  const Vector2d at = rounded(conflict.at);
  Ring inner{at};
  for (std::size_t k = conflict.i + 1; k <= conflict.j; ++k) append_new(inner, ring[k]);
  Ring outer{at};
  for (std::size_t k = conflict.j + 1; k < ring.size(); ++k) append_new(outer, ring[k]);
  for (std::size_t k = 0; k <= conflict.i; ++k) append_new(outer, ring[k]);
  return {closed_up(std::move(inner)), closed_up(std::move(outer))};
}

bool is_distinct(const Ring& ring) {
  if (ring.size() < 3 || ring.back() == ring.front()) return false;
  return std::adjacent_find(ring.begin(), ring.end()) == ring.end();
}

}  // namespace

double signed_area_m2(const Ring& ring) {
  double twice = 0;
  for (std::size_t i = 1; i + 1 < ring.size(); ++i) twice += cross(ring[i] - ring[0], ring[i + 1] - ring[0]);
  return 0.5 * twice;
}

Eigen::AlignedBox2d bounding_box(const Ring& ring) {
  Eigen::AlignedBox2d box;
  for (const Vector2d& point : ring) box.extend(point);
  return box;
}

bool in_bounds(const Ring& ring) {
  return std::all_of(ring.begin(), ring.end(), [](const Vector2d& point) { return in_bounds(point); });
}

bool encloses(const Ring& ring, const Vector2d& point) {
  bool inside = false;
  for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    const Vector2d& a = ring[i];
    const Vector2d& b = ring[j];
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    if (point.x() < a.x() + (point.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
  }
  return inside;
}

Meeting meet(const Vector2d& a0, const Vector2d& a1, const Vector2d& b0, const Vector2d& b1) {
  if (std::max(a0.x(), a1.x()) < std::min(b0.x(), b1.x()) ||
      std::max(b0.x(), b1.x()) < std::min(a0.x(), a1.x()) ||
      std::max(a0.y(), a1.y()) < std::min(b0.y(), b1.y()) ||
      std::max(b0.y(), b1.y()) < std::min(a0.y(), a1.y())) {
    return {};
  }
  const double a0_side = orientation(b0, b1, a0);
  const double a1_side = orientation(b0, b1, a1);
  if ((a0_side > 0 && a1_side > 0) || (a0_side < 0 && a1_side < 0)) return {};
  const double b0_side = orientation(a0, a1, b0);
  const double b1_side = orientation(a0, a1, b1);
  if ((b0_side > 0 && b1_side > 0) || (b0_side < 0 && b1_side < 0)) return {};

  if (a0_side != 0 && a1_side != 0 && b0_side != 0 && b1_side != 0) {
    return {Meeting::crossing, a0 + a0_side / (a0_side - a1_side) * (a1 - a0)};
  }
  // An end that lies on the other segment, not only on its line, is the better place to part a ring.
  const std::pair<double, const Vector2d*> ends[] = {{distance_to_segment_m(a0, b0, b1), &a0},
                                                     {distance_to_segment_m(a1, b0, b1), &a1},
                                                     {distance_to_segment_m(b0, a0, a1), &b0},
                                                     {distance_to_segment_m(b1, a0, a1), &b1}};
  const auto nearest =
      std::min_element(std::begin(ends), std::end(ends), [](auto& a, auto& b) { return a.first < b.first; });
  return {Meeting::touching, *nearest->second};
}

bool is_simple(const Ring& ring) { return is_distinct(ring) && in_bounds(ring) && !find_conflict(ring); }

std::vector<Ring> simple_loops(const Ring& ring) {
  if (is_simple(ring)) {
    if (std::abs(signed_area_m2(ring)) < min_ring_area_m2) return {};
    return {ring};
  }
  constexpr int max_meetings = 100;
  std::vector<Ring> loops;
  std::vector<Ring> waiting{cleaned(ring)};
  for (int meetings = 0; !waiting.empty();) {
    const Ring loop = std::move(waiting.back());
    waiting.pop_back();
    if (loop.size() < 3) continue;
    if (const auto conflict = find_conflict(loop)) {
      if (++meetings > max_meetings) return {};
      auto [inner, outer] = parted(loop, *conflict);
      waiting.push_back(std::move(inner));
      waiting.push_back(std::move(outer));
    } else if (std::abs(signed_area_m2(loop)) >= min_ring_area_m2) {
      loops.push_back(loop);
    }
  }
  return loops;
}

Ring without_straight_points(const Ring& ring, double tolerance_m) {
  Ring kept;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vector2d& before = kept.empty() ? ring.back() : kept.back();
    const Vector2d& after = i + 1 < ring.size() ? ring[i + 1] : (kept.empty() ? ring.front() : kept.front());
    if (distance_to_segment_m(ring[i], before, after) > tolerance_m) kept.push_back(ring[i]);
  }
  return kept;
}

std::vector<std::size_t> simplify_chain(const std::vector<Vector2d>& chain, double tolerance_m,
                                        std::size_t max_gap) {
  std::vector<std::size_t> kept;
  if (chain.empty()) return kept;
  kept.push_back(0);
  max_gap = std::max<std::size_t>(max_gap, 1);
  // Ends of the stretches still to look at; the next one in order is on top.
  std::vector<std::size_t> ends;
  for (std::size_t begin = 0; begin + 1 < chain.size();) {
    const std::size_t block_end = std::min(begin + max_gap, chain.size() - 1);
    ends.assign(1, block_end);
    while (!ends.empty()) {
      const std::size_t end = ends.back();
      std::size_t farthest = begin;
      double distance = tolerance_m;
      for (std::size_t k = begin + 1; k < end; ++k) {
        const double d = distance_to_segment_m(chain[k], chain[begin], chain[end]);
        if (d > distance) {
          distance = d;
          farthest = k;
        }
      }
      if (farthest != begin) {
        ends.push_back(farthest);
      } else {
        kept.push_back(end);
        begin = end;
        ends.pop_back();
      }
    }
  }
  return kept;
}

}  // namespace isthmus
