#include "server/output/tables/annotation_table.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "server/engine/annotations/polygon_check.hpp"
#include "server/output/format/atomic_file.hpp"

namespace isthmus {
namespace {

using Json = nlohmann::ordered_json;

/// To a tenth of a millimetre.
double rounded(double value) {
  const double result = std::round(value * 1e4) / 1e4;
  return result == 0 ? 0 : result;
}

Json position_of(const Eigen::Vector2d& point) {
  return Json::array({rounded(point.x()), rounded(point.y())});
}

Pose on_plane(const MapCopy& map, const ManifoldPose& point) {
  return map.poses[static_cast<std::size_t>(point.patch.value)] * point.patch_from_object;
}

/// A ring ends where it begins, and goes round counter-clockwise.
Json polygon_of(const MapCopy& map, const AnnotationRecord& zone) {
  std::vector<Eigen::Vector2d> ring;
  for (const ManifoldPose& corner : zone.points) ring.push_back(position(on_plane(map, corner)));
  if (signed_area_m2(ring) < 0) std::reverse(ring.begin(), ring.end());
  ring.push_back(ring.front());
  Json coordinates = Json::array();
  for (const Eigen::Vector2d& corner : ring) coordinates.push_back(position_of(corner));
  return {{"type", "Polygon"}, {"coordinates", Json::array({coordinates})}};
}

Json geometry_of(const MapCopy& map, const AnnotationRecord& annotation) {
  if (annotation.lost) return nullptr;
  if (is_zone(annotation.kind)) return polygon_of(map, annotation);
  return {{"type", "Point"},
          {"coordinates", position_of(position(on_plane(map, annotation.points.front())))}};
}

Json feature_of(const MapCopy& map, int island, const AnnotationRecord& annotation) {
  Json properties = {
      {"kind", word(annotation.kind)}, {"name", annotation.name}, {"island", annotation.lost ? -1 : island}};
  if (annotation.kind == AnnotationKind::place && !annotation.lost)
    properties["yaw_rad"] = rounded(on_plane(map, annotation.points.front()).yaw);
  if (annotation.kind == AnnotationKind::speed) properties["max_speed_m_s"] = annotation.max_speed_m_s;
  properties["lost"] = annotation.lost;
  Json points = Json::array();
  for (const ManifoldPose& point : annotation.points)
    points.push_back(Json::array(
        {point.patch.value, rounded(point.patch_from_object.x), rounded(point.patch_from_object.y)}));
  properties["points"] = std::move(points);
  return {
      {"type", "Feature"}, {"geometry", geometry_of(map, annotation)}, {"properties", std::move(properties)}};
}

}  // namespace

std::string annotations_geojson(const MapCopy& map, const std::function<int(IslandId)>& number_of) {
  Json features = Json::array();
  for (const AnnotationRecord& annotation : map.annotations)
    features.push_back(feature_of(map, number_of(annotation.island), annotation));
  const Json collection = {{"type", "FeatureCollection"},
                           {"coordinate_frame", "the plane of each feature's island, metres; not WGS 84"},
                           {"features", std::move(features)}};
  return collection.dump(1) + "\n";
}

std::string annotations_geojson(const MapCopy& map, const RankedIslands& islands) {
  return annotations_geojson(map, [&](IslandId island) { return islands.rank(island); });
}

void write_annotations(const MapCopy& map, const RankedIslands& islands, const std::string& path) {
  if (map.annotations.empty()) {
    std::error_code ignored;  // a file that cannot be removed is no reason to fail an export
    std::filesystem::remove(path, ignored);
    return;
  }
  AtomicFile file(path);
  file.write(annotations_geojson(map, islands));
  file.commit();
}

}  // namespace isthmus
