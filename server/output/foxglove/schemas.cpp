#include <nlohmann/json.hpp>

#include "server/output/foxglove/messages.hpp"

namespace isthmus::foxglove {
namespace {

using Json = nlohmann::ordered_json;

Json object(const Json& properties) { return {{"type", "object"}, {"properties", properties}}; }
Json array_of(const Json& items) { return {{"type", "array"}, {"items", items}}; }

const Json number = {{"type", "number"}}, integer = {{"type", "integer"}}, string = {{"type", "string"}},
           boolean = {{"type", "boolean"}};

Json time() {
  Json object_of_time = object({{"sec", {{"type", "integer"}, {"minimum", 0}}},
                                {"nsec", {{"type", "integer"}, {"minimum", 0}, {"maximum", 999999999}}}});
  object_of_time["title"] = "time";
  return object_of_time;
}
Json duration() {
  Json object_of_time = object({{"sec", integer}, {"nsec", integer}});
  object_of_time["title"] = "duration";
  return object_of_time;
}
Json vector() { return object({{"x", number}, {"y", number}, {"z", number}}); }
Json quaternion() { return object({{"x", number}, {"y", number}, {"z", number}, {"w", number}}); }
Json pose() { return object({{"position", vector()}, {"orientation", quaternion()}}); }
Json colour() { return object({{"r", number}, {"g", number}, {"b", number}, {"a", number}}); }
Json bytes() { return {{"type", "string"}, {"contentEncoding", "base64"}}; }

Json frame_transforms_fields() {
  return object({{"transforms", array_of(object({{"timestamp", time()},
                                                 {"parent_frame_id", string},
                                                 {"child_frame_id", string},
                                                 {"translation", vector()},
                                                 {"rotation", quaternion()}}))}});
}

Json pose_in_frame_fields() {
  return object({{"timestamp", time()}, {"frame_id", string}, {"pose", pose()}});
}

Json laser_scan_fields() {
  return object({{"timestamp", time()},
                 {"frame_id", string},
                 {"pose", pose()},
                 {"start_angle", number},
                 {"end_angle", number},
                 {"ranges", array_of(number)},
                 {"intensities", array_of(number)}});
}

Json grid_fields() {
  return object({{"timestamp", time()},
                 {"frame_id", string},
                 {"pose", pose()},
                 {"column_count", integer},
                 {"cell_size", object({{"x", number}, {"y", number}})},
                 {"row_stride", integer},
                 {"cell_stride", integer},
                 {"fields", array_of(object({{"name", string}, {"offset", integer}, {"type", integer}}))},
                 {"data", bytes()}});
}

Json scene_entity() {
  const Json solid = object({{"pose", pose()}, {"size", vector()}, {"color", colour()}});
  return object({{"timestamp", time()},
                 {"frame_id", string},
                 {"id", string},
                 {"lifetime", duration()},
                 {"frame_locked", boolean},
                 {"metadata", array_of(object({{"key", string}, {"value", string}}))},
                 {"arrows", array_of(object(Json::object()))},
                 {"cubes", array_of(solid)},
                 {"spheres", array_of(solid)},
                 {"cylinders", array_of(object(Json::object()))},
                 {"lines", array_of(object({{"type", integer},
                                            {"pose", pose()},
                                            {"thickness", number},
                                            {"scale_invariant", boolean},
                                            {"points", array_of(vector())},
                                            {"color", colour()},
                                            {"colors", array_of(colour())},
                                            {"indices", array_of(integer)}}))},
                 {"triangles", array_of(object(Json::object()))},
                 {"texts", array_of(object({{"pose", pose()},
                                            {"billboard", boolean},
                                            {"font_size", number},
                                            {"scale_invariant", boolean},
                                            {"color", colour()},
                                            {"text", string}}))},
                 {"models", array_of(object(Json::object()))}});
}

Json scene_update_fields() {
  return object({{"deletions", array_of(object({{"timestamp", time()}, {"type", integer}, {"id", string}}))},
                 {"entities", array_of(scene_entity())}});
}

Json log_fields() {
  return object({{"timestamp", time()},
                 {"level", integer},
                 {"message", string},
                 {"name", string},
                 {"file", string},
                 {"line", integer}});
}

Schema named(const std::string& name, Json schema) {
  schema["title"] = "foxglove." + name;
  return {"foxglove." + name, schema.dump()};
}

}  // namespace

Schema schema(Kind kind) {
  switch (kind) {
    case Kind::frame_transforms:
      return named("FrameTransforms", frame_transforms_fields());
    case Kind::pose_in_frame:
      return named("PoseInFrame", pose_in_frame_fields());
    case Kind::laser_scan:
      return named("LaserScan", laser_scan_fields());
    case Kind::grid:
      return named("Grid", grid_fields());
    case Kind::scene_update:
      return named("SceneUpdate", scene_update_fields());
    case Kind::log:
      break;
  }
  return named("Log", log_fields());
}

}  // namespace isthmus::foxglove
