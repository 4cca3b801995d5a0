#include "patches/features/m_space.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace isthmus {
namespace {

/// x across, y along the segment; or, of a corner, x along the bisector.
struct Frame {
  Eigen::Vector2d origin;
  Eigen::Vector2d x;
  Eigen::Vector2d y;
};

Frame frame_of(const Feature& feature) {
  switch (feature.kind) {
    case FeatureKind::segment:
      return {0.5 * (feature.a + feature.b), across(feature), along(feature)};
    case FeatureKind::corner:
      return {feature.a, along(feature), -across(feature)};
    case FeatureKind::point:
    case FeatureKind::pole:
      break;
  }
  return {feature.a, Eigen::Vector2d::UnitX(), Eigen::Vector2d::UnitY()};
}

Eigen::Vector2d in_frame(const Frame& frame, const Eigen::Vector2d& point) {
  const Eigen::Vector2d offset = point - frame.origin;
  return {frame.x.dot(offset), frame.y.dot(offset)};
}

LocalVector segment_coordinates(const Frame& frame, const Feature& feature) {
  const Eigen::Vector2d a = in_frame(frame, feature.a), b = in_frame(frame, feature.b);
  const Eigen::Vector2d t = (b - a).normalized();
  const Eigen::Vector2d n(t.y(), -t.x());
  LocalVector x_p(4);
  x_p << std::atan2(-t.x(), t.y()), n.dot(a), t.dot(a), t.dot(b);
  return x_p;
}

/// By a and b in the frame: α turns by n·(a − b) / L, and ρ, d_A, d_B with it.
LocalMatrix segment_jacobian(const Frame& frame, const Feature& feature) {
  const Eigen::Vector2d a = in_frame(frame, feature.a), b = in_frame(frame, feature.b);
  const double length = (b - a).norm();
  const Eigen::Vector2d t = (b - a) / length;
  const Eigen::Vector2d n(t.y(), -t.x());
  const double rho = n.dot(a);
  LocalMatrix by(4, 4);
  by.row(0) << n.transpose() / length, -n.transpose() / length;
  by.row(1) << n.transpose(), 0, 0;
  by.row(2) << t.transpose(), 0, 0;
  by.row(3) << 0, 0, t.transpose();
  by.row(1) += t.dot(a) * by.row(0);
  by.row(2) -= rho * by.row(0);
  by.row(3) -= rho * by.row(0);
  Eigen::Matrix2d axes;
  axes << frame.x.transpose(), frame.y.transpose();
  by.leftCols<2>() = (by.leftCols<2>() * axes).eval();
  by.rightCols<2>() = (by.rightCols<2>() * axes).eval();
  return by;
}

LocalVector corner_coordinates(const Frame& frame, const Feature& feature) {
  const Eigen::Vector2d apex = in_frame(frame, feature.a);
  const Eigen::Vector2d bisector = in_frame(frame, feature.b) - apex;
  LocalVector x_p(3);
  x_p << apex, std::atan2(bisector.y(), bisector.x());
  return x_p;
}

LocalMatrix corner_jacobian(const Frame& frame, const Feature& feature) {
  const Eigen::Vector2d bisector = feature.b - feature.a;
  const Eigen::RowVector2d turn = Eigen::RowVector2d(-bisector.y(), bisector.x()) / bisector.squaredNorm();
  LocalMatrix by = LocalMatrix::Zero(3, 4);
  by.row(0).head<2>() = frame.x.transpose();
  by.row(1).head<2>() = frame.y.transpose();
  by.row(2) << -turn, turn;
  return by;
}

/// B̃ of a feature that is wholly known: coordinate_count by full_dimension.
LocalMatrix full_projection(const Feature& feature) {
  const int rows = coordinate_count(feature.kind);
  if (feature.kind == FeatureKind::segment) {
    const Eigen::Vector2d n = across(feature), t = along(feature);
    const double half = 0.5 * length_m(feature);
    LocalMatrix by = LocalMatrix::Zero(4, 4);
    by.col(0) << half * n, -half * n;
    by.col(1) << n, n;
    by.col(2).head<2>() = t;
    by.col(3).tail<2>() = t;
    return by;
  }
  if (feature.kind == FeatureKind::corner) {
    const Frame frame = frame_of(feature);
    LocalMatrix by = LocalMatrix::Zero(4, 3);
    by.col(0) << frame.x, frame.x;
    by.col(1) << frame.y, frame.y;
    by.col(2).tail<2>() = frame.y * length_m(feature);
    return by;
  }
  return LocalMatrix::Identity(rows, rows);
}

}  // namespace

LocalVector coordinates(const Feature& feature) {
  LocalVector x_f(coordinate_count(feature.kind));
  x_f.head<2>() = feature.a;
  if (point_count(feature.kind) == 2) x_f.tail<2>() = feature.b;
  if (feature.kind == FeatureKind::pole) x_f(2) = feature.radius_m;
  return x_f;
}

Feature with_coordinates(const Feature& feature, const LocalVector& x_f) {
  Feature result = feature;
  result.a = x_f.head<2>();
  if (point_count(feature.kind) == 2) result.b = x_f.tail<2>();
  if (feature.kind == FeatureKind::pole) result.radius_m = x_f(2);
  return result;
}

LocalVector local_coordinates(const Feature& frame, const Feature& feature) {
  const Frame axes = frame_of(frame);
  if (frame.kind == FeatureKind::segment) return segment_coordinates(axes, feature);
  if (frame.kind == FeatureKind::corner) return corner_coordinates(axes, feature);
  LocalVector x_p(full_dimension(frame.kind));
  x_p.head<2>() = in_frame(axes, feature.a);
  if (frame.kind == FeatureKind::pole) x_p(2) = feature.radius_m;
  return x_p;
}

LocalMatrix local_jacobian(const Feature& frame, const Feature& feature) {
  const Frame axes = frame_of(frame);
  if (frame.kind == FeatureKind::segment) return segment_jacobian(axes, feature);
  if (frame.kind == FeatureKind::corner) return corner_jacobian(axes, feature);
  const int size = full_dimension(frame.kind);
  return LocalMatrix::Identity(size, size);
}

LocalVector local_difference(FeatureKind kind, const LocalVector& x_p, const LocalVector& other) {
  LocalVector difference = x_p - other;
  if (kind == FeatureKind::segment) difference(0) = wrap_angle(difference(0));
  if (kind == FeatureKind::corner) difference(2) = wrap_angle(difference(2));
  return difference;
}

LocalMatrix rows_of(const LocalMatrix& full, const std::array<bool, 4>& which) {
  LocalMatrix rows(full.rows(), full.cols());
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < full.rows(); ++i)
    if (which[static_cast<std::size_t>(i)]) rows.row(count++) = full.row(i);
  return rows.topRows(count);
}

LocalVector rows_of(const LocalVector& full, const std::array<bool, 4>& which) {
  LocalVector rows(full.size());
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < full.size(); ++i)
    if (which[static_cast<std::size_t>(i)]) rows(count++) = full(i);
  return rows.head(count);
}

LocalMatrix project_to_local(const Feature& feature) {
  return rows_of(local_jacobian(feature, feature), known_components(feature));
}

LocalMatrix project_to_feature(const Feature& feature) {
  const LocalMatrix full = full_projection(feature).transpose();
  return rows_of(full, known_components(feature)).transpose();
}

Feature corrected(const Feature& feature, const LocalVector& delta_x_p) {
  const LocalVector x_f = coordinates(feature) + project_to_feature(feature) * delta_x_p;
  Feature result = with_coordinates(feature, x_f);
  if (feature.kind == FeatureKind::corner) result.b = result.a + along(result);
  if (result.radius_m < 0) result.radius_m = 0;
  return result;
}

Stretched stretched(const Feature& segment, double a_m, double b_m) {
  const double half = 0.5 * length_m(segment);
  if (segment.end_a_known) a_m = -half;
  if (segment.end_b_known) b_m = half;
  const Eigen::Vector2d middle = 0.5 * (segment.a + segment.b), t = along(segment);
  const int q = dimension(segment);
  Stretched result{segment, LocalMatrix::Identity(q, q)};
  if (b_m - a_m <= shortest_segment_m) return result;
  if (!segment.end_a_known) result.feature.a = middle + a_m * t;
  if (!segment.end_b_known) result.feature.b = middle + b_m * t;
  result.change(1, 0) = -0.5 * (a_m + b_m);
  return result;
}

bool is_sound(const ObservedFeature& observed) {
  const LocalMatrix& covariance = observed.covariance;
  if (!is_sound(observed.feature)) return false;
  if (covariance.rows() != dimension(observed.feature) || covariance.rows() != covariance.cols())
    return false;
  if (!covariance.allFinite()) return false;
  const double largest = covariance.diagonal().maxCoeff();
  if (!(covariance - covariance.transpose()).isZero(1e-9 * largest)) return false;
  const Eigen::LLT<LocalMatrix> factor(covariance);
  return factor.info() == Eigen::Success && covariance.diagonal().minCoeff() > 1e-18;
}

}  // namespace isthmus
