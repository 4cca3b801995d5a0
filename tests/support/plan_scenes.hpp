#pragma once

#include <cmath>
#include <vector>

#include "server/output/vector_plan/vector_plan.hpp"

namespace isthmus::testing {

/// What a scan saw of a wall from `a` (on its right) to `b`: 1 cm and 0.2 degrees.
inline FeatureSeen wall_seen(int view, const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                             bool a_known = false, bool b_known = false) {
  FeatureSeen seen;
  seen.view = view;
  seen.observed.feature = segment_feature(a, b, a_known, b_known);
  const Eigen::Index q = dimension(seen.observed.feature);
  seen.observed.covariance = LocalMatrix::Identity(q, q) * 1e-4;
  seen.observed.covariance(0, 0) = 1.2e-5;
  return seen;
}

inline FeatureSeen pole_seen(int view, const Eigen::Vector2d& centre, double radius_m) {
  FeatureSeen seen;
  seen.view = view;
  seen.observed.feature = pole_feature(centre, radius_m, true);
  seen.observed.covariance = LocalMatrix::Identity(3, 3) * 1e-4;
  return seen;
}

/// A view whose beams end at points from `from` to `to`, 5 cm apart.
inline View fan(const Eigen::Vector2d& eye, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  View view{eye, {}};
  const int parts = static_cast<int>(std::ceil((to - from).norm() / 0.05));
  for (int i = 0; i <= parts; ++i) view.ends.push_back(from + (to - from) * (static_cast<double>(i) / parts));
  return view;
}

}  // namespace isthmus::testing
