#include <cmath>
#include <nlohmann/json.hpp>

#include "server/output/vector_plan/plan_files.hpp"

namespace isthmus {
namespace {

using Json = nlohmann::ordered_json;

/// To a tenth of a millimetre: what is measured is coarser.
double rounded(double value) {
  const double result = std::round(value * 1e4) / 1e4;
  return result == 0 ? 0 : result;
}

Json position_of(const Eigen::Vector2d& at) { return Json::array({rounded(at.x()), rounded(at.y())}); }

Json feature(const char* type, Json coordinates, Json properties) {
  return {{"type", "Feature"},
          {"geometry", {{"type", type}, {"coordinates", std::move(coordinates)}}},
          {"properties", std::move(properties)}};
}

Json line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, Json properties) {
  return feature("LineString", Json::array({position_of(a), position_of(b)}), std::move(properties));
}

}  // namespace

std::string plan_geojson(const VectorPlan& plan, const std::string& frame) {
  Json features = Json::array();
  for (const PlanWall& wall : plan.walls)
    features.push_back(
        line(wall.a, wall.b, {{"kind", "wall"}, {"sigma_m", rounded(wall.sigma_m)}, {"views", wall.views}}));
  for (const PlanOpening& opening : plan.openings)
    features.push_back(line(opening.a, opening.b, {{"kind", "opening"}}));
  for (const PlanPole& pole : plan.poles) {
    Json properties = {{"kind", "pole"}, {"sigma_m", rounded(pole.sigma_m)}, {"views", pole.views}};
    properties["radius_m"] = pole.radius_known ? Json(rounded(pole.radius_m)) : Json();
    features.push_back(feature("Point", position_of(pole.centre), std::move(properties)));
  }
  const Json collection = {{"type", "FeatureCollection"},
                           {"coordinate_frame", frame + "; not WGS 84"},
                           {"features", std::move(features)}};
  return collection.dump(1) + "\n";
}

}  // namespace isthmus
