#include "server/engine/sightings/evidence.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace isthmus {
namespace {

// A covariance of (x, y, yaw) with its position turned into the pose's own axes.
Eigen::Matrix3d in_own_axes(const Eigen::Matrix3d& covariance, double yaw) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(-yaw).toRotationMatrix();
  return turn * covariance * turn.transpose();
}

double axis_variance(const Eigen::Matrix3d& covariance) {
  return 0.5 * covariance.topLeftCorner<2, 2>().trace();
}

Vector5d yaw_row(bool sine, double sigma_rad) {
  Vector5d row = Vector5d::Zero();
  row(sine ? 1 : 0) = 1 / sigma_rad;
  if (!sine) row(4) = -1 / sigma_rad;
  return row;
}

Relation related(const Evidence& evidence, RelationKind kind, Measurement measurement, ClosureId closure,
                 const EvidenceOptions& options) {
  Relation relation;
  relation.a = evidence.observer.pose.patch;
  relation.b = evidence.target_place->pose.patch;
  relation.kind = kind;
  relation.measurement = std::move(measurement);
  relation.origin = {OriginKind::sighting, closure, static_cast<std::int32_t>(evidence.record)};
  relation.robust_scale = options.robust_scale;
  return relation;
}

}  // namespace

std::string tag_name(std::int32_t barcode) { return "TAG " + std::to_string(barcode); }

PatchPtr make_tag_patch(PatchId id, std::int32_t barcode, std::int64_t utime) {
  auto patch = std::make_shared<Patch>();
  patch->id = id;
  patch->robot = tag_name(barcode);
  patch->utime = utime;
  patch->tag = barcode;
  return patch;
}

ProjectedSighting project_sighting_of_point(const Map& map, const Evidence& evidence,
                                            const Eigen::Vector2d& target, double target_variance) {
  const SightingEvent& s = evidence.sighting;
  ProjectedSighting sighting;
  sighting.utime = s.utime;
  sighting.plane_from_observer = map.manifold().project(evidence.observer.pose);
  sighting.observer_covariance =
      in_own_axes(evidence.observer.covariance, evidence.observer.pose.patch_from_object.yaw);
  sighting.target = target;
  sighting.target_variance = target_variance;
  sighting.range_m = s.range_m;
  sighting.range_sigma_m = s.range_sigma_m;
  sighting.bearing_rad = s.bearing_rad;
  sighting.bearing_sigma_rad = s.bearing_sigma_rad;
  return sighting;
}

ProjectedSighting project_sighting(const Map& map, const Evidence& evidence) {
  const PastPlace& target = *evidence.target_place;
  return project_sighting_of_point(map, evidence, position(map.manifold().project(target.pose)),
                                   axis_variance(target.covariance));
}

std::optional<Eigen::Vector2d> measured_point(const Map& map, const Evidence& evidence) {
  const SightingEvent& s = evidence.sighting;
  if (!std::isfinite(s.range_sigma_m) || !std::isfinite(s.bearing_sigma_rad)) return std::nullopt;
  return map.manifold().project(evidence.observer.pose) *
         Eigen::Vector2d(s.range_m * std::cos(s.bearing_rad), s.range_m * std::sin(s.bearing_rad));
}

bool places_a_point(std::size_t sightings, double apart_m, const EvidenceOptions& options) {
  return sightings >= static_cast<std::size_t>(options.common.agreeing) ||
         (sightings >= 2 && apart_m >= options.min_apart_m);
}

bool PointConsensus::enough(const EvidenceOptions& options) const {
  return places_a_point(supporters.size(), apart_m, options);
}

PointConsensus agree_on_a_point(const Map& map, const std::vector<Evidence>& pool,
                                const std::vector<std::size_t>& members, const AlignmentOptions& options) {
  PointConsensus best;
  for (const std::size_t i : members) {
    const std::optional<Eigen::Vector2d> point = measured_point(map, pool[i]);
    if (!point) continue;
    const SightingEvent& s = pool[i].sighting;
    const double sigma = std::max(s.range_sigma_m, s.range_m * s.bearing_sigma_rad);
    std::vector<std::size_t> agreeing;
    for (const std::size_t j : members)
      if (j == i || agrees(project_sighting_of_point(map, pool[j], *point, sigma * sigma), Pose{}, options))
        agreeing.push_back(j);
    if (agreeing.size() > best.supporters.size()) best.supporters = std::move(agreeing);
  }
  int points = 0;
  for (const std::size_t i : best.supporters) {
    const Eigen::Vector2d from = position(map.manifold().project(pool[i].observer.pose));
    const Eigen::Vector2d first =
        position(map.manifold().project(pool[best.supporters.front()].observer.pose));
    best.apart_m = std::max(best.apart_m, (from - first).norm());
    if (const auto point = measured_point(map, pool[i])) {
      best.point += *point;
      ++points;
    }
  }
  if (points > 0) best.point /= points;
  return best;
}

std::optional<Relation> sighting_relation(const Map& map, const Evidence& evidence, ClosureId closure,
                                          const AlignmentOptions& alignment, const EvidenceOptions& options) {
  const SightingEvent& s = evidence.sighting;
  const PatchId a = evidence.observer.pose.patch;
  const PatchId b = evidence.target_place->pose.patch;
  if (a == b) return std::nullopt;
  const Pose& a_from_observer = evidence.observer.pose.patch_from_object;
  const Eigen::Vector2d point_b = position(evidence.target_place->pose.patch_from_object);
  const Eigen::Matrix3d own = in_own_axes(evidence.observer.covariance, a_from_observer.yaw);
  const double variance = axis_variance(evidence.target_place->covariance) + axis_variance(own) +
                          alignment.floor_m * alignment.floor_m;
  const double yaw_variance = own(2, 2) + alignment.floor_rad * alignment.floor_rad;
  const bool has_range = std::isfinite(s.range_sigma_m);
  const bool has_bearing = std::isfinite(s.bearing_sigma_rad);
  const double range_sigma = options.correlation * std::sqrt(s.range_sigma_m * s.range_sigma_m + variance);
  const double range = std::max(has_range ? s.range_m : options.no_range_m, options.min_range_m);
  const double bearing_variance = s.bearing_sigma_rad * s.bearing_sigma_rad + yaw_variance;
  if (!has_bearing) {
    return related(evidence, RelationKind::range,
                   Range{position(a_from_observer), point_b, s.range_m, range_sigma}, closure, options);
  }
  if (!has_range) {
    return related(evidence, RelationKind::bearing,
                   Bearing{a_from_observer, point_b, s.bearing_rad,
                           options.correlation * std::sqrt(bearing_variance + variance / (range * range))},
                   closure, options);
  }
  const double across_sigma = options.correlation * std::sqrt(bearing_variance * range * range + variance);
  const Eigen::Vector2d radial = rotate(a_from_observer.yaw + s.bearing_rad, Eigen::Vector2d(1, 0));
  const Eigen::Vector2d seen = position(a_from_observer) + s.range_m * radial;
  QuadraticFormBuilder form;
  form.point_on_line(point_b, seen, radial, range_sigma);
  form.point_on_line(point_b, seen, {-radial.y(), radial.x()}, across_sigma);
  if (map.manifold().patch(b).tag >= 0) {
    form.row(yaw_row(true, options.no_yaw_sigma_rad));
    form.row(yaw_row(false, options.no_yaw_sigma_rad));
  }
  return related(evidence, RelationKind::range_bearing, Correspondences{form.build(), 1, {}}, closure,
                 options);
}

}  // namespace isthmus
