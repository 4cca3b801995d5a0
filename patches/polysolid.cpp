#include "patches/polysolid.hpp"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_set_2.h>
#include <CGAL/assertions_behaviour.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <span>
#include <utility>

namespace isthmus {
namespace {

using Eigen::Vector2d;
using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using ExactSet = CGAL::Polygon_set_2<Kernel>;
using ExactPolygon = ExactSet::Polygon_2;

// Rounding an exact set to doubles moves points by far less; straight points that cross no other ring are
// left over wherever two edges once met.
constexpr double straight_tolerance_m = 1e-7;

// CGAL's assertions are what stands between a ring it cannot take and undefined behaviour: they throw here,
// silently, and the operation has no answer.
template <class Operation>
auto guarded(Operation operation) -> std::optional<decltype(operation())> {
  static const bool configured = [] {
    CGAL::set_error_behaviour(CGAL::THROW_EXCEPTION);
    CGAL::set_error_handler([](const char*, const char*, const char*, int, const char*) {});
    return true;
  }();
  static_cast<void>(configured);
  try {
    return operation();
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

// A simple ring, turned counter-clockwise.
ExactPolygon exact_polygon(const Ring& ring) {
  ExactPolygon polygon;
  const bool clockwise = signed_area_m2(ring) < 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vector2d& point = ring[clockwise ? ring.size() - 1 - i : i];
    polygon.push_back(Kernel::Point_2(point.x(), point.y()));
  }
  return polygon;
}

ExactSet even_odd(const Ring& ring) {
  ExactSet set;
  for (const Ring& loop : simple_loops(ring)) {
    if (set.is_empty()) {
      set.insert(exact_polygon(loop));
    } else {
      set.symmetric_difference(exact_polygon(loop));
    }
  }
  return set;
}

ExactSet exact_set(const std::vector<PolygonWithHoles>& polygons);

// Rounding may carry a hole's corner over an edge of its ring by a hair: taking the difference stands that,
// handing CGAL a polygon with holes does not.
ExactSet exact_set(const PolygonWithHoles& polygon) {
  ExactSet set = even_odd(polygon.outer);
  if (polygon.holes.empty()) return set;
  std::vector<PolygonWithHoles> holes;
  for (const Ring& hole : polygon.holes) holes.push_back({hole, {}});
  set.difference(exact_set(holes));
  return set;
}

// Simple rings are joined in one sweep; only what has holes or meets itself needs a set of its own first.
ExactSet exact_set(const std::vector<PolygonWithHoles>& polygons) {
  std::vector<ExactPolygon> simple;
  std::vector<ExactSet> others;
  for (const PolygonWithHoles& polygon : polygons) {
    if (polygon.holes.empty() && is_simple(polygon.outer)) {
      if (std::abs(signed_area_m2(polygon.outer)) < min_ring_area_m2) continue;
      simple.push_back(exact_polygon(polygon.outer));
    } else {
      others.push_back(exact_set(polygon));
    }
  }
  ExactSet set;
  if (simple.size() == 1) {
    set.insert(simple.front());
  } else {
    set.join(simple.begin(), simple.end());
  }
  for (const ExactSet& other : others) set.join(other);
  return set;
}

ExactSet exact_set(const Polysolid& solid) { return exact_set(solid.polygons()); }

// A lazy number converts with five good digits only, unless it has been evaluated.
double rounded(const Kernel::FT& number) {
  const auto& interval = number.approx();
  return interval.is_point() ? interval.inf() : CGAL::to_double(number.exact());
}

Ring rounded_ring(const ExactPolygon& polygon) {
  Ring ring;
  ring.reserve(polygon.size());
  for (auto vertex = polygon.vertices_begin(); vertex != polygon.vertices_end(); ++vertex) {
    ring.emplace_back(rounded(vertex->x()), rounded(vertex->y()));
  }
  return ring;
}

Ring tidied(const Ring& loop) {
  Ring tidy = without_straight_points(loop, straight_tolerance_m);
  return is_simple(tidy) ? tidy : loop;
}

double net_area_m2(const PolygonWithHoles& polygon) {
  double area = signed_area_m2(polygon.outer);
  for (const Ring& hole : polygon.holes) area += signed_area_m2(hole);
  return area;
}

// The smallest ring around a hole; islands lie within larger rings. A hole may touch its ring at a corner,
// hence the middle of an edge. One that fills its ring but for a hair may seem to lie outside every ring, by
// rounding: it belongs to the largest, whose parts they all are.
PolygonWithHoles* owner_of(const Ring& hole, std::span<PolygonWithHoles> polygons) {
  const auto smaller = [](const PolygonWithHoles& a, const PolygonWithHoles& b) {
    return signed_area_m2(a.outer) < signed_area_m2(b.outer);
  };
  const Vector2d inside = 0.5 * (hole[0] + hole[1]);
  PolygonWithHoles* owner = nullptr;
  for (PolygonWithHoles& polygon : polygons) {
    if (encloses(polygon.outer, inside) && (owner == nullptr || smaller(polygon, *owner))) owner = &polygon;
  }
  if (owner != nullptr || polygons.empty()) return owner;
  return &*std::max_element(polygons.begin(), polygons.end(), smaller);
}

// The boundary of one exact polygon. CGAL's rings may pass one point twice and are parted there: a ring that
// closes on itself leaves a clockwise loop, which is a hole, and a hole with an island at its rim leaves a
// counter-clockwise one, which is the island; CGAL does not list it apart.
void append_rounded(const ExactSet::Polygon_with_holes_2& exact, std::vector<PolygonWithHoles>& polygons) {
  const std::size_t first = polygons.size();
  std::vector<Ring> holes;
  const auto sort_out = [&](const ExactPolygon& ring) {
    for (const Ring& loop : simple_loops(rounded_ring(ring))) {
      if (signed_area_m2(loop) > 0) {
        polygons.push_back({tidied(loop), {}});
      } else {
        holes.push_back(tidied(loop));
      }
    }
  };
  sort_out(exact.outer_boundary());
  std::for_each(exact.holes_begin(), exact.holes_end(), sort_out);
  const std::span own = std::span(polygons).subspan(first);
  for (Ring& hole : holes) {
    if (PolygonWithHoles* owner = owner_of(hole, own)) owner->holes.push_back(std::move(hole));
  }
  polygons.erase(std::remove_if(polygons.begin() + static_cast<std::ptrdiff_t>(first), polygons.end(),
                                [](const auto& polygon) { return net_area_m2(polygon) < min_ring_area_m2; }),
                 polygons.end());
}

Polysolid rounded(const ExactSet& set) {
  std::vector<ExactSet::Polygon_with_holes_2> exact;
  set.polygons_with_holes(std::back_inserter(exact));
  std::vector<PolygonWithHoles> polygons;
  for (const auto& polygon : exact) append_rounded(polygon, polygons);
  return Polysolid::of_sound(std::move(polygons));
}

Eigen::AlignedBox2d box_of(const Polysolid& solid) {
  Eigen::AlignedBox2d box;
  for (const PolygonWithHoles& polygon : solid.polygons()) box.extend(bounding_box(polygon.outer));
  return box;
}

bool share_area(const Eigen::AlignedBox2d& a, const Eigen::AlignedBox2d& b) {
  return !a.isEmpty() && !b.isEmpty() && (a.min().array() < b.max().array()).all() &&
         (b.min().array() < a.max().array()).all();
}

struct Edge {
  Vector2d from;
  Vector2d to;
};

// Edges of a solid that come into a box.
std::vector<Edge> edges_in(const Polysolid& solid, const Eigen::AlignedBox2d& box) {
  std::vector<Edge> edges;
  const auto append = [&](const Ring& ring) {
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
      Eigen::AlignedBox2d edge_box(ring[j]);
      if (box.intersects(edge_box.extend(ring[i]))) edges.push_back({ring[j], ring[i]});
    }
  };
  for (const PolygonWithHoles& polygon : solid.polygons()) {
    append(polygon.outer);
    std::for_each(polygon.holes.begin(), polygon.holes.end(), append);
  }
  return edges;
}

bool has_a_ring_within(const Polysolid& inner, const Polysolid& outer) {
  for (const PolygonWithHoles& polygon : inner.polygons()) {
    if (!polygon.outer.empty() && contains(outer, polygon.outer.front())) return true;
    for (const Ring& hole : polygon.holes) {
      if (!hole.empty() && contains(outer, hole.front())) return true;
    }
  }
  return false;
}

// Nothing where boundaries touch and doubles do not tell. Boundaries that cross share area on one side of the
// crossing; boundaries that stay apart share area only if a ring of one lies within the other.
std::optional<bool> overlap_by_doubles(const Polysolid& a, const Polysolid& b) {
  const Eigen::AlignedBox2d box_a = box_of(a);
  const Eigen::AlignedBox2d box_b = box_of(b);
  if (!share_area(box_a, box_b)) return false;
  const Eigen::AlignedBox2d common = box_a.intersection(box_b);
  const std::vector<Edge> edges_b = edges_in(b, common);
  bool touching = false;
  for (const Edge& edge_a : edges_in(a, common)) {
    for (const Edge& edge_b : edges_b) {
      const Meeting::Kind kind = meet(edge_a.from, edge_a.to, edge_b.from, edge_b.to).kind;
      if (kind == Meeting::crossing) return true;
      touching = touching || kind == Meeting::touching;
    }
  }
  if (touching) return std::nullopt;
  return has_a_ring_within(a, b) || has_a_ring_within(b, a);
}

// Whether one polygon, oriented as polygons() promises, can be taken as it is.
bool is_sound(const PolygonWithHoles& polygon) {
  return polygon.holes.empty() && is_simple(polygon.outer) &&
         signed_area_m2(polygon.outer) >= min_ring_area_m2;
}

}  // namespace

Polysolid Polysolid::of_sound(std::vector<PolygonWithHoles> polygons) {
  Polysolid solid;
  solid.polygons_ = std::move(polygons);
  return solid;
}

Polysolid::Polysolid(std::vector<PolygonWithHoles> polygons) {
  if (polygons.size() == 1 && is_sound(polygons.front())) {
    polygons_ = std::move(polygons);
  } else if (auto united = guarded([&] { return rounded(exact_set(polygons)); })) {
    *this = std::move(*united);
  }
}

bool overlap(const Polysolid& a, const Polysolid& b) {
  if (const auto known = overlap_by_doubles(a, b)) return *known;
  return guarded([&] { return exact_set(a).do_intersect(exact_set(b)); }).value_or(true);
}

bool contains(const Polysolid& solid, const Vector2d& point) {
  const auto has = [&](const Ring& ring) { return encloses(ring, point); };
  return std::any_of(solid.polygons().begin(), solid.polygons().end(), [&](const PolygonWithHoles& polygon) {
    return has(polygon.outer) && std::none_of(polygon.holes.begin(), polygon.holes.end(), has);
  });
}

Polysolid transformed(const Pose& a_from_b, const Polysolid& solid_b) {
  if (!is_finite(a_from_b)) return {};
  const Vector2d translation = position(a_from_b);
  Eigen::Matrix2d rotation;
  rotation << std::cos(a_from_b.yaw), -std::sin(a_from_b.yaw), std::sin(a_from_b.yaw), std::cos(a_from_b.yaw);
  std::vector<PolygonWithHoles> polygons = solid_b.polygons();
  const auto move = [&](Ring& ring) {
    for (Vector2d& point : ring) point = rotation * point + translation;
  };
  for (PolygonWithHoles& polygon : polygons) {
    move(polygon.outer);
    std::for_each(polygon.holes.begin(), polygon.holes.end(), move);
  }
  return Polysolid::of_sound(std::move(polygons));
}

std::string to_wkt(const Polysolid& solid, int decimals) {
  if (solid.empty()) return "MULTIPOLYGON EMPTY";
  const int places = std::clamp(decimals, 0, 17);
  const auto number = [&](double value) {
    char text[400];
    const int length = std::snprintf(text, sizeof text, "%.*f", places, value);
    std::string written(text, static_cast<std::size_t>(std::max(length, 0)));
    const bool is_zero = written.find_first_not_of("-0.") == std::string::npos;
    return is_zero && written.front() == '-' ? written.substr(1) : written;
  };
  const auto ring_text = [&](const Ring& ring) -> std::string {
    if (ring.empty()) return "EMPTY";
    std::string text = "(";
    for (const Vector2d& point : ring) text += number(point.x()) + " " + number(point.y()) + ", ";
    return text + number(ring.front().x()) + " " + number(ring.front().y()) + ")";
  };
  std::string text = "MULTIPOLYGON (";
  for (const PolygonWithHoles& polygon : solid.polygons()) {
    if (text.back() != '(') text += ", ";
    text += "(" + ring_text(polygon.outer);
    for (const Ring& hole : polygon.holes) text += ", " + ring_text(hole);
    text += ")";
  }
  return text + ")";
}

}  // namespace isthmus
