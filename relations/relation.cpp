#include "relations/relation.hpp"

#include <algorithm>
#include <cmath>

#include "relations/residuals.hpp"

namespace isthmus {
namespace {

Pose nearest(const Correspondences& measured, const Pose& start) {
  return measured.form.minimum(start).a_from_b;
}

Pose nearest(const RelativePose& measured, const Pose&) { return measured.a_from_b; }

/// b moved without turning until its point lies at `target_a`.
Pose with_point_at(const Pose& start, const Eigen::Vector2d& point_b, const Eigen::Vector2d& target_a) {
  const Eigen::Vector2d move = target_a - start * point_b;
  return {start.x + move.x(), start.y + move.y(), start.yaw};
}

Pose nearest(const Range& measured, const Pose& start) {
  const Eigen::Vector2d between = start * measured.point_b - measured.point_a;
  const double distance = between.norm();
  const Eigen::Vector2d direction =
      distance > 0 ? Eigen::Vector2d(between / distance) : Eigen::Vector2d::UnitX();
  return with_point_at(start, measured.point_b, measured.point_a + measured.range_m * direction);
}

Pose nearest(const Bearing& measured, const Pose& start) {
  const Eigen::Vector2d observer(measured.a_from_observer.x, measured.a_from_observer.y);
  const double distance = (start * measured.point_b - observer).norm();
  const double angle = measured.a_from_observer.yaw + measured.bearing_rad;
  return with_point_at(start, measured.point_b,
                       observer + distance * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
}

double chi_squared(const Measurement& measurement, double cost) {
  const auto* correspondences = std::get_if<Correspondences>(&measurement);
  const double min_cost = correspondences ? correspondences->least.cost : 0;
  return std::max(0.0, 2 * (cost - min_cost));
}

}  // namespace

std::string_view name(OriginKind kind) {
  switch (kind) {
    case OriginKind::odometry:
      return "odometry";
    case OriginKind::match:
      return "match";
    case OriginKind::sighting:
      return "sighting";
    case OriginKind::propagation:
      return "propagation";
    case OriginKind::hypothesis:
      return "hypothesis";
    case OriginKind::start:
      return "start";
  }
  return "unknown";
}

std::string_view name(RelationKind kind) {
  switch (kind) {
    case RelationKind::point_to_line:
      return "point_to_line";
    case RelationKind::point_to_point:
      return "point_to_point";
    case RelationKind::line_to_line:
      return "line_to_line";
    case RelationKind::range_bearing:
      return "range_bearing";
    case RelationKind::relative_pose:
      return "relative_pose";
    case RelationKind::odometry:
      return "odometry";
    case RelationKind::range:
      return "range";
    case RelationKind::bearing:
      return "bearing";
  }
  return "unknown";
}

int count(const Relation& relation) {
  const auto* correspondences = std::get_if<Correspondences>(&relation.measurement);
  return correspondences ? correspondences->count : 1;
}

double cost(const Measurement& measurement, const Pose& a_from_b) {
  return 0.5 * linearise(measurement, a_from_b).e.squaredNorm();
}

double cost(const Relation& relation, const Pose& a_from_b) {
  const double scale = relation.robust_scale;
  if (scale <= 0) return cost(relation.measurement, a_from_b);
  return 0.5 * scale * scale * std::log1p(chi_squared(relation.measurement, a_from_b) / (scale * scale));
}

double chi_squared(const Measurement& measurement, const Pose& a_from_b) {
  return chi_squared(measurement, cost(measurement, a_from_b));
}

double robust_weight(double chi_squared, double robust_scale) {
  if (robust_scale <= 0) return 1;
  return 1 / (1 + chi_squared / (robust_scale * robust_scale));
}

Eigen::Matrix3d information(const Measurement& measurement, const Pose& a_from_b) {
  if (const auto* correspondences = std::get_if<Correspondences>(&measurement))
    return correspondences->form.information(a_from_b);
  const LinearResidual residual = linearise(measurement, a_from_b);
  return residual.by_a_from_b.transpose() * residual.by_a_from_b;
}

Eigen::Matrix3d information(const Relation& relation, const Pose& a_from_b) {
  if (relation.robust_scale <= 0) return information(relation.measurement, a_from_b);
  const LinearResidual residual = linearise(relation.measurement, a_from_b);
  const Eigen::Matrix3d full = residual.by_a_from_b.transpose() * residual.by_a_from_b;
  const double above_least = chi_squared(relation.measurement, 0.5 * residual.e.squaredNorm());
  return robust_weight(above_least, relation.robust_scale) * full;
}

Pose minimiser(const Measurement& measurement, const Pose& start) {
  return std::visit([&](const auto& measured) { return nearest(measured, start); }, measurement);
}

}  // namespace isthmus
