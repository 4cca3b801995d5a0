#include "tools/simulate/plan/floor_plan.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "patches/segment.hpp"
#include "tools/simulate/plan/random.hpp"

namespace isthmus {
namespace {

using Eigen::Vector2d;

// Makes surfaces of corners, one face after the other, with the building's roughness and gloss.
class Mason {
 public:
  explicit Mason(const Building& building)
      : building_(building), roughness_(building.seed, "roughness"), gloss_(building.seed, "gloss") {}

  void choose_gloss() {
    limit_ = gloss_.chance(building_.glossy_share) ? building_.glossy_incidence_rad : std::numbers::pi;
  }

  // A face is straight, or bulges a little at a knot every facet_m; its ends stay, so faces meet.
  void face(const Vector2d& from, const Vector2d& to) {
    const double length = (to - from).norm();
    if (length < 1e-9) return;
    const Vector2d normal = Vector2d(from.y() - to.y(), to.x() - from.x()) / length;
    const int pieces =
        building_.roughness_m > 0 ? std::max(1, static_cast<int>(length / building_.facet_m)) : 1;
    Vector2d previous = from;
    for (int i = 1; i <= pieces; ++i) {
      Vector2d next = from + (to - from) * i / pieces;
      if (i < pieces) next += roughness_.normal(building_.roughness_m) * normal;
      segments_.push_back({previous, next, limit_});
      previous = next;
    }
  }

  void ring(const std::vector<Vector2d>& corners) {
    for (std::size_t i = 0; i < corners.size(); ++i) face(corners[i], corners[(i + 1) % corners.size()]);
  }

  // A straight piece of wall: its two sides and two ends, or one line where walls have no thickness.
  void piece(const Vector2d& from, const Vector2d& to) {
    const double half = 0.5 * building_.wall_thickness_m;
    if (half <= 0) return face(from, to);
    const Vector2d direction = (to - from).normalized();
    const Vector2d side = half * Vector2d(-direction.y(), direction.x());
    ring({from - side, to - side, to + side, from + side});
  }

  std::vector<Segment> segments() { return std::move(segments_); }

 private:
  const Building& building_;
  Random roughness_;
  Random gloss_;
  double limit_ = std::numbers::pi;
  std::vector<Segment> segments_;
};

// One edge of a wall's polyline, between distances `start` and `start + length` along the wall, less its
// doors. At the edge's own ends the wall reaches on by half its thickness, so that corners are closed.
void add_edge(Mason& mason, const Building& building, const Wall& wall, const Vector2d& from,
              const Vector2d& to, double start) {
  const double length = (to - from).norm();
  if (length < 1e-9) return;
  const Vector2d direction = (to - from) / length;
  const double beyond = 0.5 * building.wall_thickness_m;
  std::vector<Door> doors = wall.doors;
  std::ranges::sort(doors, {}, &Door::along_m);
  double at = -beyond;
  for (const Door& door : doors) {
    const double opens = door.along_m - 0.5 * door.width_m - start;
    const double closes = opens + door.width_m;
    if (closes <= 0 || opens >= length) continue;
    if (opens > at) mason.piece(from + at * direction, from + opens * direction);
    at = std::max(at, closes);
  }
  if (at < length) mason.piece(from + at * direction, from + (length + beyond) * direction);
}

void add_wall(Mason& mason, const Building& building, const Wall& wall) {
  double start = 0;
  const std::size_t n = wall.corners.size();
  for (std::size_t i = 0; i + 1 < n + (wall.closed ? 1 : 0); ++i) {
    const Vector2d& from = wall.corners[i];
    const Vector2d& to = wall.corners[(i + 1) % n];
    mason.choose_gloss();
    add_edge(mason, building, wall, from, to, start);
    start += (to - from).norm();
  }
}

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

bool cross_each_other(const Segment& s, const Segment& t) {
  const Vector2d u = s.b - s.a, v = t.b - t.a;
  return cross(u, t.a - s.a) * cross(u, t.b - s.a) < 0 && cross(v, s.a - t.a) * cross(v, s.b - t.a) < 0;
}

}  // namespace

FloorPlan build_floor_plan(const Building& building) {
  Mason mason(building);
  for (const Wall& wall : building.walls) add_wall(mason, building, wall);
  for (const auto& corners : building.furniture) {
    mason.choose_gloss();
    mason.ring(corners);
  }
  FloorPlan plan;
  plan.segments = mason.segments();
  if (plan.segments.empty()) return plan;
  plan.low = plan.high = plan.segments.front().a;
  for (const Segment& segment : plan.segments) {
    plan.low = plan.low.cwiseMin(segment.a).cwiseMin(segment.b);
    plan.high = plan.high.cwiseMax(segment.a).cwiseMax(segment.b);
  }
  return plan;
}

double distance_m(const Vector2d& point, const Segment& segment) {
  return distance_to_segment_m(point, segment.a, segment.b);
}

double distance_m(const Segment& a, const Segment& b) {
  if (cross_each_other(a, b)) return 0;
  return std::min({distance_m(a.a, b), distance_m(a.b, b), distance_m(b.a, a), distance_m(b.b, a)});
}

double clearance_m(const FloorPlan& plan, const Vector2d& from, const Vector2d& to) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Segment& segment : plan.segments) {
    nearest = std::min(nearest, distance_m(Segment{from, to}, segment));
  }
  return nearest;
}

}  // namespace isthmus
