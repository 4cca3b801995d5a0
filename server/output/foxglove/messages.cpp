#include "server/output/foxglove/messages.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "server/output/foxglove/base64.hpp"

namespace isthmus::foxglove {
namespace {

using Json = nlohmann::ordered_json;

constexpr double millimetres = 1e3;
constexpr double digits = 1e6;
constexpr int free_cell = 0, occupied_cell = 100, unknown_cell = 255;
constexpr int type_uint8 = 1;  ///< of foxglove.PackedElementField
constexpr int line_list = 2;   ///< of foxglove.LinePrimitive
constexpr int of_id = 0;       ///< of foxglove.SceneEntityDeletion
constexpr double patch_m = 0.12, tag_m = 0.25, closure_m = 0.05, text_m = 0.4;

Json time(std::int64_t utime) {
  const std::int64_t since_1970 = std::max<std::int64_t>(utime, 0);
  return {{"sec", since_1970 / 1'000'000}, {"nsec", since_1970 % 1'000'000 * 1'000}};
}

/// With as many digits as say something: messages are a third as long.
double rounded(double value) { return std::round(value * digits) / digits; }

Json vector(double x, double y, double z) {
  return {{"x", rounded(x)}, {"y", rounded(y)}, {"z", rounded(z)}};
}

Json turn(double yaw_rad) {
  return {
      {"x", 0.0}, {"y", 0.0}, {"z", rounded(std::sin(yaw_rad / 2))}, {"w", rounded(std::cos(yaw_rad / 2))}};
}

Json json(const Pose& pose) {
  return {{"position", vector(pose.x, pose.y, 0)}, {"orientation", turn(pose.yaw)}};
}

Json colour(double r, double g, double b) { return {{"r", r}, {"g", g}, {"b", b}, {"a", 1.0}}; }

Json place(const Eigen::Vector2d& at) { return json(Pose{at.x(), at.y(), 0}); }

std::uint8_t cell(std::uint8_t pixel) {
  if (pixel == OccupancyGrid::occupied) return occupied_cell;
  return pixel == OccupancyGrid::free ? free_cell : unknown_cell;
}

Json text(const Mark& mark) {
  return {{"pose", place(mark.place)}, {"billboard", true},        {"font_size", text_m},
          {"scale_invariant", false},  {"color", colour(0, 0, 0)}, {"text", mark.text}};
}

Json marks(const std::vector<Mark>& places, double size_m, const Json& in_colour) {
  Json list = Json::array();
  for (const Mark& mark : places)
    list.push_back(
        {{"pose", place(mark.place)}, {"size", vector(size_m, size_m, size_m)}, {"color", in_colour}});
  return list;
}

Json lines(const std::vector<SceneLine>& all) {
  if (all.empty()) return Json::array();
  Json points = Json::array();
  for (const SceneLine& line : all)
    for (const Eigen::Vector2d& end : {line.from, line.to}) points.push_back(vector(end.x(), end.y(), 0));
  return Json::array({{{"type", line_list},
                       {"pose", json(Pose{})},
                       {"thickness", closure_m},
                       {"scale_invariant", false},
                       {"points", points},
                       {"color", colour(0.84, 0.37, 0)},
                       {"colors", Json::array()},
                       {"indices", Json::array()}}});
}

Json entity(std::int64_t utime, const Scene& scene) {
  Json texts = Json::array();
  for (const Mark& tag : scene.tags) texts.push_back(text(tag));
  return {{"timestamp", time(utime)},
          {"frame_id", scene.frame},
          {"id", scene.frame},
          {"lifetime", {{"sec", 0}, {"nsec", 0}}},
          {"frame_locked", true},
          {"metadata", Json::array()},
          {"arrows", Json::array()},
          {"cubes", marks(scene.tags, tag_m, colour(0.94, 0.89, 0.26))},
          {"spheres", marks(scene.patches, patch_m, colour(0, 0.45, 0.7))},
          {"cylinders", Json::array()},
          {"lines", lines(scene.closures)},
          {"triangles", Json::array()},
          {"texts", texts},
          {"models", Json::array()}};
}

}  // namespace

std::string frame_transforms(std::int64_t utime, const std::vector<Transform>& transforms) {
  Json list = Json::array();
  for (const Transform& one : transforms)
    list.push_back({{"timestamp", time(utime)},
                    {"parent_frame_id", one.parent},
                    {"child_frame_id", one.child},
                    {"translation", vector(one.parent_from_child.x, one.parent_from_child.y, 0)},
                    {"rotation", turn(one.parent_from_child.yaw)}});
  return Json{{"transforms", list}}.dump();
}

std::string pose_in_frame(std::int64_t utime, const std::string& frame, const Pose& frame_from_robot) {
  return Json{{"timestamp", time(utime)}, {"frame_id", frame}, {"pose", json(frame_from_robot)}}.dump();
}

std::string laser_scan(const Scan& scan, const Laser& laser, const std::string& frame) {
  Json ranges = Json::array();
  for (const float range_m : scan.ranges_m) {
    const bool hit = classify(range_m, laser) == BeamKind::hit;
    ranges.push_back(hit ? std::round(range_m * millimetres) / millimetres : 0.0);
  }
  const double beams = static_cast<double>(scan.ranges_m.size());
  return Json{{"timestamp", time(scan.utime)},
              {"frame_id", frame},
              {"pose", json(Pose{})},
              {"start_angle", scan.bearing0_rad},
              {"end_angle", scan.bearing0_rad + std::max(0.0, beams - 1) * scan.bearing_step_rad},
              {"ranges", ranges},
              {"intensities", Json::array()}}
      .dump();
}

std::string grid(std::int64_t utime, const OccupancyGrid& cells, const std::string& frame) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(cells.pixels.size());
  const auto width = static_cast<std::size_t>(cells.width);
  for (int row = cells.height - 1; row >= 0; --row)
    for (std::size_t column = 0; column < width; ++column)
      bytes.push_back(cell(cells.pixels[static_cast<std::size_t>(row) * width + column]));
  return Json{{"timestamp", time(utime)},
              {"frame_id", frame},
              {"pose", json(Pose{cells.origin_x_m, cells.origin_y_m, 0})},
              {"column_count", cells.width},
              {"cell_size", {{"x", cells.resolution_m}, {"y", cells.resolution_m}}},
              {"row_stride", cells.width},
              {"cell_stride", 1},
              {"fields", {{{"name", "occupancy"}, {"offset", 0}, {"type", type_uint8}}}},
              {"data", base64(bytes)}}
      .dump();
}

std::string log(std::int64_t utime, Level level, const std::string& message) {
  return Json{{"timestamp", time(utime)},
              {"level", static_cast<int>(level)},
              {"message", message},
              {"name", "isthmus"},
              {"file", ""},
              {"line", 0}}
      .dump();
}

std::string scene_update(std::int64_t utime, const std::vector<Scene>& scenes,
                         const std::vector<std::string>& gone) {
  Json deletions = Json::array(), entities = Json::array();
  for (const std::string& frame : gone)
    deletions.push_back({{"timestamp", time(utime)}, {"type", of_id}, {"id", frame}});
  for (const Scene& scene : scenes) entities.push_back(entity(utime, scene));
  return Json{{"deletions", deletions}, {"entities", entities}}.dump();
}

}  // namespace isthmus::foxglove
