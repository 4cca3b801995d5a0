#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

namespace isthmus {

/// A closed polyline of points in metres, without a repeated last point.
using Ring = std::vector<Eigen::Vector2d>;

/// Rings enclosing less than this are nothing.
inline constexpr double min_ring_area_m2 = 1e-6;
/// Coordinates beyond this are taken for garbage, as NaN is.
inline constexpr double max_coordinate_m = 1e6;

/// Positive for a counter-clockwise ring.
double signed_area_m2(const Ring& ring);

Eigen::AlignedBox2d bounding_box(const Ring& ring);

/// Whether every coordinate is finite and within max_coordinate_m.
bool in_bounds(const Ring& ring);

/// Even-odd rule. Points on the boundary may come out either way; a non-finite point is outside.
bool encloses(const Ring& ring, const Eigen::Vector2d& point);

/// How two segments meet. `crossing` and `apart` are certain: they hold in exact arithmetic. `touching` means
/// that they share a point or come so close that doubles do not tell; `at` is an end of one of them.
struct Meeting {
  enum Kind { apart, crossing, touching } kind = apart;
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
};
Meeting meet(const Eigen::Vector2d& a0, const Eigen::Vector2d& a1, const Eigen::Vector2d& b0,
             const Eigen::Vector2d& b1);

/// True only if the ring is simple in exact arithmetic and holds three points or more; a ring that touches
/// itself, or nearly so, is not.
bool is_simple(const Ring& ring);

/// The ring's even-odd interior as simple loops whose interiors are to be combined by exclusive or. A simple
/// ring comes back as it is. Otherwise non-finite points are dropped, the rest rounded to a nanometre, and
/// the ring is parted wherever it meets itself, spikes included. Loops below min_ring_area_m2 are dropped; a
/// ring that meets itself too often to be anything but noise gives none.
std::vector<Ring> simple_loops(const Ring& ring);

/// Leaves out points nearer than `tolerance_m` to the segment between their neighbours.
Ring without_straight_points(const Ring& ring, double tolerance_m);

/// Douglas-Peucker: which points of an open chain to keep so that no point left out is farther than
/// `tolerance_m` from the segment that replaces it. Ends are kept, and so is every `max_gap`-th point, which
/// bounds the work at size * max_gap.
std::vector<std::size_t> simplify_chain(const std::vector<Eigen::Vector2d>& chain, double tolerance_m,
                                        std::size_t max_gap);

}  // namespace isthmus
