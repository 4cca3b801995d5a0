#include "server/paths/ground/zones.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include "patches/segment.hpp"
#include "server/engine/annotations/polygon_check.hpp"

namespace isthmus {
namespace {

using Point = Eigen::Vector2d;

double cross(const Point& a, const Point& b) { return a.x() * b.y() - a.y() * b.x(); }

bool cross_each_other(const Point& a, const Point& b, const Point& c, const Point& d) {
  return cross(b - a, c - a) * cross(b - a, d - a) < 0 && cross(d - c, a - c) * cross(d - c, b - c) < 0;
}

double distance_m(const Point& a, const Point& b, const Point& c, const Point& d) {
  if (cross_each_other(a, b, c, d)) return 0;
  return std::min({distance_to_segment_m(a, c, d), distance_to_segment_m(b, c, d),
                   distance_to_segment_m(c, a, b), distance_to_segment_m(d, a, b)});
}

/// Visits the rows of cells whose centres lie between two heights, with those heights.
template <class Visit>
void visit_rows(double low_m, double high_m, const Visit& visit) {
  const auto first = static_cast<std::int32_t>(std::ceil(low_m / ground_cell_m - 0.5));
  const auto last = static_cast<std::int32_t>(std::floor(high_m / ground_cell_m - 0.5));
  for (std::int32_t row = first; row <= last; ++row) visit(row, (row + 0.5) * ground_cell_m);
}

/// Where a ring crosses a height, and which way.
struct Crossing {
  double x = 0;
  int turn = 0;
};

}  // namespace

bool comes_into(const Zone& zone, const Point& from, const Point& to, double radius_m) {
  const Eigen::AlignedBox2d way(from.cwiseMin(to).array() - radius_m, from.cwiseMax(to).array() + radius_m);
  if (!way.intersects(zone.box)) return false;
  if (is_inside(zone.ring, from) || is_inside(zone.ring, to)) return true;
  for (std::size_t i = 0; i < zone.ring.size(); ++i)
    if (distance_m(from, to, zone.ring[i], zone.ring[(i + 1) % zone.ring.size()]) <= radius_m) return true;
  return false;
}

Zones::Zones(const MapCopy& map) {
  for (const AnnotationRecord& annotation : map.annotations) {
    if (!is_zone(annotation.kind) || annotation.lost) continue;
    Zone zone;
    zone.keep_out = annotation.kind == AnnotationKind::keep_out;
    zone.max_speed_m_s = annotation.max_speed_m_s;
    for (const ManifoldPose& corner : annotation.points) {
      zone.ring.push_back(
          position(map.poses[static_cast<std::size_t>(corner.patch.value)] * corner.patch_from_object));
      zone.box.extend(zone.ring.back());
    }
    zones_[annotation.island].push_back(std::move(zone));
  }
}

std::span<const Zone> Zones::of(IslandId island) const {
  const auto found = zones_.find(island);
  return found == zones_.end() ? std::span<const Zone>() : found->second;
}

void Zones::keep(IslandId island, const Zones& others) {
  const std::span<const Zone> kept = others.of(island);
  if (kept.empty()) {
    zones_.erase(island);
  } else {
    zones_[island].assign(kept.begin(), kept.end());
  }
}

bool Zones::any_keep_out(IslandId island) const {
  return std::ranges::any_of(of(island), [](const Zone& zone) { return zone.keep_out; });
}

bool Zones::bars(IslandId island, const Point& from, const Point& to, double radius_m) const {
  return std::ranges::any_of(
      of(island), [&](const Zone& zone) { return zone.keep_out && comes_into(zone, from, to, radius_m); });
}

double Zones::max_speed_m_s(IslandId island, const Point& from, const Point& to, double radius_m) const {
  double slowest = 0;
  for (const Zone& zone : of(island)) {
    if (zone.keep_out || (slowest > 0 && zone.max_speed_m_s >= slowest)) continue;
    if (comes_into(zone, from, to, radius_m)) slowest = zone.max_speed_m_s;
  }
  return slowest;
}

bool are_alike(std::span<const Zone> a, std::span<const Zone> b) {
  const auto is_near = [](const Point& one, const Point& other) {
    return (one - other).norm() <= 0.5 * ground_cell_m;
  };
  return std::ranges::equal(a, b, [&](const Zone& one, const Zone& other) {
    return one.keep_out == other.keep_out && one.max_speed_m_s == other.max_speed_m_s &&
           std::ranges::equal(one.ring, other.ring, is_near);
  });
}

KeptOutCells::KeptOutCells(std::span<const Zone> zones, double within_m) {
  for (const Zone& zone : zones) {
    if (!zone.keep_out) continue;
    add_inside(zone);
    for (std::size_t i = 0; i < zone.ring.size(); ++i)
      add_around(zone.ring[i], zone.ring[(i + 1) % zone.ring.size()], within_m);
  }
  join_spans();
}

bool KeptOutCells::contains(const Cell& cell) const {
  const auto row = rows_.find(cell.y);
  if (row == rows_.end()) return false;
  const Spans& spans = row->second;
  const auto after = std::ranges::upper_bound(spans, cell.x, {}, &Spans::value_type::first);
  return after != spans.begin() && std::prev(after)->second >= cell.x;
}

void KeptOutCells::add(std::int32_t row, double low_m, double high_m) {
  const auto first = static_cast<std::int32_t>(std::ceil(low_m / ground_cell_m - 0.5));
  const auto last = static_cast<std::int32_t>(std::floor(high_m / ground_cell_m - 0.5));
  if (first <= last) rows_[row].emplace_back(first, last);
}

void KeptOutCells::add_inside(const Zone& zone) {
  std::map<std::int32_t, std::vector<Crossing>> crossings;
  for (std::size_t i = 0; i < zone.ring.size(); ++i) {
    const Point &a = zone.ring[i], &b = zone.ring[(i + 1) % zone.ring.size()];
    const auto [low, high] = std::minmax(a.y(), b.y());
    visit_rows(low, high, [&](std::int32_t row, double y) {
      if ((a.y() <= y) == (b.y() <= y)) return;
      crossings[row].push_back(
          {a.x() + (b.x() - a.x()) * (y - a.y()) / (b.y() - a.y()), a.y() <= y ? 1 : -1});
    });
  }
  for (auto& [row, of_row] : crossings) {
    std::ranges::stable_sort(of_row, {}, &Crossing::x);
    int winding = 0;
    for (std::size_t i = 0; i + 1 < of_row.size(); ++i) {
      winding += of_row[i].turn;
      if (winding != 0) add(row, of_row[i].x, of_row[i + 1].x);
    }
  }
}

/// What is near a side is convex: of each height one stretch of it.
void KeptOutCells::add_around(const Point& a, const Point& b, double within_m) {
  const auto [low, high] = std::minmax(a.y(), b.y());
  const Point along = b - a;
  const double length = along.norm();
  const Point out =
      length > 0 ? Point(within_m * Point(-along.y(), along.x()) / length) : Point(Point::Zero());
  const std::array<Point, 4> corners = {a + out, b + out, b - out, a - out};
  visit_rows(low - within_m, high + within_m, [&](std::int32_t row, double y) {
    double left = std::numeric_limits<double>::infinity(), right = -left;
    const auto extend = [&](double x) {
      left = std::min(left, x);
      right = std::max(right, x);
    };
    for (const Point& end : {a, b}) {
      const double up = y - end.y();
      if (std::abs(up) > within_m) continue;
      const double half = std::sqrt(within_m * within_m - up * up);
      extend(end.x() - half);
      extend(end.x() + half);
    }
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Point &from = corners[i], &to = corners[(i + 1) % corners.size()];
      if ((from.y() <= y) != (to.y() <= y))
        extend(from.x() + (to.x() - from.x()) * (y - from.y()) / (to.y() - from.y()));
    }
    add(row, left, right);
  });
}

void KeptOutCells::join_spans() {
  for (auto& [row, spans] : rows_) {
    std::ranges::sort(spans);
    Spans joined;
    for (const auto& span : spans) {
      if (joined.empty() || span.first > joined.back().second + 1)
        joined.push_back(span);
      else
        joined.back().second = std::max(joined.back().second, span.second);
    }
    spans = std::move(joined);
  }
}

}  // namespace isthmus
