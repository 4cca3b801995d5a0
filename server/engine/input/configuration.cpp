#include "server/engine/input/configuration.hpp"

#include <limits>
#include <utility>

#include "server/engine/input/robot_name.hpp"
#include "server/engine/input/settings.hpp"
#include "server/engine/input/tuning.hpp"

namespace isthmus {
namespace {

/// One byte less than the journal's configuration message can hold.
constexpr std::size_t max_toml_bytes = 64 * 1024 - 1;

void read_engine(const Setting& table, EngineOptions& options) {
  Fields fields(table, " in [engine]");
  fields.read_within("local_map_position_m", options.local_map.position_m, 0.01, 100);
  fields.read_within("local_map_yaw_rad", options.local_map.yaw_rad, 0.001, 3.2);
  fields.read_within("patch_spacing_m", options.patch_spacing_m, 0.05, 100);
  fields.read_within("patch_spacing_rad", options.patch_spacing_rad, 0.05, 6.3);
  fields.read_within("uncovered_share", options.uncovered_share, 0.01, 1);
  fields.read_within("free_space_range_m", options.patch.free_space.max_range_m, 0.5, 1000);
  fields.read_within("no_return_range_m", options.patch.free_space.no_return_range_m, 0, 1000);
  fields.finish();
}

void read_limits(const Setting& table, EngineOptions& options) {
  Fields fields(table, " in [limits]");
  fields.read_within("patches_per_robot", options.patches_per_robot, 1, 10'000'000);
  fields.finish();
}

void read_laser(const Setting& table, Laser& laser) {
  Fields fields(table, " in laser");
  fields.read_within("x_m", laser.robot_from_laser.x, -100, 100);
  fields.read_within("y_m", laser.robot_from_laser.y, -100, 100);
  fields.read_within("yaw_rad", laser.robot_from_laser.yaw, -6.3, 6.3);
  fields.finish();
}

MeasuredStart read_start(const Setting& table, const std::string& robot) {
  Fields fields(table, " in start");
  MeasuredStart start;
  const bool has_with = fields.read("with", start.with);
  fields.read_within("x", start.with_from_robot.x, -1e5, 1e5);
  fields.read_within("y", start.with_from_robot.y, -1e5, 1e5);
  fields.read_within("yaw", start.with_from_robot.yaw, -6.3, 6.3);
  fields.read_within("sigma_x", start.sigma.x(), 1e-4, 1e3);
  fields.read_within("sigma_y", start.sigma.y(), 1e-4, 1e3);
  fields.read_within("sigma_yaw", start.sigma.z(), 1e-4, 3.2);
  fields.finish();  // first: a name that is nearly 'with' may stand there
  if (!has_with) fail_at(table.where, "start needs 'with', the robot it is measured from");
  start.with = upper_case(start.with);
  if (!is_robot_name(start.with)) fail_at(table.where, "start.with must be a robot's name");
  if (start.with == robot) fail_at(table.where, "start.with must be another robot");
  return start;
}

/// 0 says that the robot has no laser; range_min_m then says nothing.
bool read_range_max(Fields& fields, double& range_max_m) {
  const Setting* setting = fields.find("range_max_m");
  if (setting == nullptr || number_of(*setting) != 0.0)
    return fields.read_within("range_max_m", range_max_m, 0.01, 1e5);
  range_max_m = 0;
  return true;
}

RobotConfiguration read_robot(const Setting& table, const std::string& name) {
  Fields fields(table, " of robot " + name);
  RobotConfiguration configuration;
  RobotEvent& robot = configuration.robot;
  robot.robot = name;
  bool described = fields.read_within("barcode", robot.barcode, -1, std::numeric_limits<std::int32_t>::max());
  described |= fields.read_within("range_min_m", robot.laser.range_min_m, 0, 1e5);
  described |= read_range_max(fields, robot.laser.range_max_m);
  described |= fields.read_within("footprint_radius_m", robot.footprint_radius_m, 0, 100);
  if (robot.laser.range_max_m > 0 && robot.laser.range_min_m >= robot.laser.range_max_m)
    fail_at(table.where, "range_min_m must be below range_max_m");
  if (const Setting* laser = fields.table("laser")) {
    read_laser(*laser, robot.laser);
    described = true;
  }
  fields.find("channels");  // the wire's
  if (const Setting* start = fields.table("start")) configuration.start = read_start(*start, name);
  fields.finish();
  configuration.declared = described || std::get<Setting::Table>(table.value).empty();
  return configuration;
}

std::string no_robot_name(const std::string& key) {
  return "'" + key + "' is no robot name: letters, digits, '_' and '-', at most 48";
}

std::string not_a_table(const std::string& robot) {
  return "robot " + robot + " must be a table: [robots." + robot + "]";
}

std::string barcode_taken(std::int32_t barcode, const std::string& robot, const std::string& wearer) {
  return "barcode " + std::to_string(barcode) + " of robot " + robot + " is given already to " + wearer;
}

void read_robots(const Setting& robots, Configuration& configuration) {
  std::map<std::int32_t, std::string> wearers;
  for (const auto& [key, setting] : std::get<Setting::Table>(robots.value)) {
    const std::string name = upper_case(key);
    if (!is_robot_name(name)) fail_at(setting.where, no_robot_name(key));
    if (!std::holds_alternative<Setting::Table>(setting.value)) fail_at(setting.where, not_a_table(name));
    const auto [robot, is_new] = configuration.robots.emplace(name, read_robot(setting, name));
    if (!is_new) fail_at(setting.where, "robot " + name + " is given twice (names compare without case)");
    const std::int32_t barcode = robot->second.robot.barcode;
    const auto [wearer, is_free] = wearers.emplace(barcode, name);
    if (barcode >= 0 && !is_free) fail_at(setting.where, barcode_taken(barcode, name, wearer->second));
  }
}

Configuration read_configuration(const Setting& table) {
  Fields fields(table);
  Configuration configuration;
  std::string tags = "declared";
  fields.read("tags", tags);
  if (tags != "declared" && tags != "any")
    fail_at(fields.where("tags"), "tags must be \"declared\" or \"any\"");
  configuration.any_tag = tags == "any";
  if (const Setting* engine = fields.table("engine")) read_engine(*engine, configuration.engine);
  if (const Setting* limits = fields.table("limits")) read_limits(*limits, configuration.engine);
  if (const Setting* tuning = fields.table("tuning")) read_tuning(*tuning, configuration.engine);
  if (const Setting* robots = fields.table("robots")) read_robots(*robots, configuration);
  for (const char* of_the_wire : {"auth", "exploration", "estimator"}) fields.find(of_the_wire);
  fields.finish();
  return configuration;
}

}  // namespace

std::variant<Configuration, std::string> parse_configuration(const std::string& toml,
                                                             const std::string& file) {
  if (toml.size() > max_toml_bytes) {
    return file + ": longer than " + std::to_string(max_toml_bytes) + " bytes";
  }
  try {
    Configuration configuration = read_configuration(parse_settings(toml, file));
    configuration.toml = toml;
    return configuration;
  } catch (const SettingError& error) {
    return error.what();
  }
}

}  // namespace isthmus
