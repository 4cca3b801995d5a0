#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace isthmus {

/// The point nearest to `point` of the segment from a to b, all in metres in one frame; a where it has no
/// length.
inline Eigen::Vector2d nearest_on_segment(const Eigen::Vector2d& point, const Eigen::Vector2d& a,
                                          const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double length2 = along.squaredNorm();
  const double share = length2 > 0 ? std::clamp((point - a).dot(along) / length2, 0.0, 1.0) : 0;
  return a + share * along;
}

/// How far `point` is from that segment, m.
inline double distance_to_segment_m(const Eigen::Vector2d& point, const Eigen::Vector2d& a,
                                    const Eigen::Vector2d& b) {
  return (point - nearest_on_segment(point, a, b)).norm();
}

}  // namespace isthmus
