#include "patches/features/feature.hpp"

#include <algorithm>
#include <cmath>

namespace isthmus {

std::string_view name(FeatureKind kind) {
  switch (kind) {
    case FeatureKind::segment:
      return "segment";
    case FeatureKind::corner:
      return "corner";
    case FeatureKind::pole:
      return "pole";
    case FeatureKind::point:
      break;
  }
  return "point";
}

Feature point_feature(const Eigen::Vector2d& place) {
  Feature feature;
  feature.a = place;
  return feature;
}

Feature segment_feature(const Eigen::Vector2d& a, const Eigen::Vector2d& b, bool end_a_known,
                        bool end_b_known) {
  Feature feature;
  feature.kind = FeatureKind::segment;
  feature.a = a;
  feature.b = b;
  feature.end_a_known = end_a_known;
  feature.end_b_known = end_b_known;
  return feature;
}

Feature corner_feature(const Eigen::Vector2d& apex, double bisector_rad, double opening_rad) {
  Feature feature;
  feature.kind = FeatureKind::corner;
  feature.a = apex;
  feature.b = apex + Eigen::Vector2d(std::cos(bisector_rad), std::sin(bisector_rad));
  feature.opening_rad = opening_rad;
  return feature;
}

Feature pole_feature(const Eigen::Vector2d& centre, double radius_m, bool radius_known) {
  Feature feature;
  feature.kind = FeatureKind::pole;
  feature.a = centre;
  feature.radius_m = radius_m;
  feature.radius_known = radius_known;
  return feature;
}

bool is_sound(const Feature& feature) {
  if (!feature.a.allFinite() || !feature.b.allFinite()) return false;
  if (!std::isfinite(feature.radius_m) || !std::isfinite(feature.opening_rad)) return false;
  switch (feature.kind) {
    case FeatureKind::segment:
      return length_m(feature) > shortest_segment_m;
    case FeatureKind::corner:
      return std::abs(length_m(feature) - 1) < 1e-3;
    case FeatureKind::pole:
      return feature.radius_m >= 0;
    case FeatureKind::point:
      break;
  }
  return true;
}

int point_count(FeatureKind kind) {
  return kind == FeatureKind::segment || kind == FeatureKind::corner ? 2 : 1;
}

int coordinate_count(FeatureKind kind) { return kind == FeatureKind::pole ? 3 : 2 * point_count(kind); }

int full_dimension(FeatureKind kind) {
  if (kind == FeatureKind::point) return 2;
  return kind == FeatureKind::segment ? 4 : 3;
}

std::array<bool, 4> known_components(const Feature& feature) {
  switch (feature.kind) {
    case FeatureKind::segment:
      return {true, true, feature.end_a_known, feature.end_b_known};
    case FeatureKind::corner:
      return {true, true, feature.heading_known, false};
    case FeatureKind::pole:
      return {true, true, feature.radius_known, false};
    case FeatureKind::point:
      break;
  }
  return {true, true, false, false};
}

int dimension(const Feature& feature) {
  const std::array<bool, 4> known = known_components(feature);
  return static_cast<int>(std::count(known.begin(), known.end(), true));
}

double length_m(const Feature& feature) { return (feature.b - feature.a).norm(); }

Eigen::Vector2d along(const Feature& feature) { return (feature.b - feature.a) / length_m(feature); }

Eigen::Vector2d across(const Feature& feature) {
  const Eigen::Vector2d t = along(feature);
  return {t.y(), -t.x()};
}

Eigen::Vector2d middle(const Feature& feature) {
  return feature.kind == FeatureKind::segment ? Eigen::Vector2d(0.5 * (feature.a + feature.b)) : feature.a;
}

Feature operator*(const Pose& a_from_b, const Feature& feature_b) {
  Feature feature = feature_b;
  feature.a = a_from_b * feature_b.a;
  if (point_count(feature_b.kind) == 2) feature.b = a_from_b * feature_b.b;
  return feature;
}

}  // namespace isthmus
