#pragma once

#include <Eigen/Core>
#include <span>

namespace isthmus {

/// Signed area of a ring of corners, in square metres: positive where they go round counter-clockwise.
double signed_area_m2(std::span<const Eigen::Vector2d> ring);

/// Whether no two sides of a ring meet but neighbours at their common corner, so that it has an inside.
bool is_simple(std::span<const Eigen::Vector2d> ring);

/// Whether a point is inside a ring, by its winding number: also where the ring has come to cross itself, all
/// that it goes around is inside.
bool is_inside(std::span<const Eigen::Vector2d> ring, const Eigen::Vector2d& point);

}  // namespace isthmus
