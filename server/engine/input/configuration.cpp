#include "server/engine/input/configuration.hpp"

#include <toml++/toml.h>
#include <charconv>
#include <limits>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "server/engine/input/robot_name.hpp"

namespace isthmus {
namespace {

/// One byte less than the journal's configuration message can hold.
constexpr std::size_t most_toml_bytes = 64 * 1024 - 1;

/// Something wrong at a line; becomes the error value of parse_configuration.
struct ConfigurationError : std::runtime_error {
  ConfigurationError(std::int64_t at_line, const std::string& reason)
      : std::runtime_error(reason), line(at_line) {}
  std::int64_t line;
};

[[noreturn]] void fail(const toml::node& at, const std::string& reason) {
  throw ConfigurationError(at.source().begin.line, reason);
}

/// Reads the keys of one table, each once; `finish` refuses those that nobody asked for.
class TableReader {
 public:
  TableReader(const toml::table& table, std::string name) : table_(table), name_(std::move(name)) {}

  const toml::node* find(const std::string& key) {
    known_.insert(key);
    return table_.get(key);
  }

  /// Leaves `value` as it is where the key is missing; ints count as numbers.
  bool number(const std::string& key, double& value, double least, double most) {
    const toml::node* node = find(key);
    if (!node) return false;
    if (!node->is_number()) fail(*node, key + " must be a number");
    const double given = node->value<double>().value_or(std::numeric_limits<double>::quiet_NaN());
    if (!(given >= least && given <= most)) {
      std::ostringstream reason;
      reason << key << " = " << given << " is not within " << least << " to " << most;
      fail(*node, reason.str());
    }
    value = given;
    return true;
  }

  bool integer(const std::string& key, std::int32_t& value, std::int32_t least, std::int32_t most) {
    const toml::node* node = find(key);
    if (!node) return false;
    const toml::value<std::int64_t>* given = node->as_integer();
    if (!given) fail(*node, key + " must be an integer");
    if (given->get() < least || given->get() > most) {
      fail(*node, key + " = " + std::to_string(given->get()) + " is not within " + std::to_string(least) +
                      " to " + std::to_string(most));
    }
    value = static_cast<std::int32_t>(given->get());
    return true;
  }

  const toml::node* text(const std::string& key, std::string& value) {
    const toml::node* node = find(key);
    if (!node) return nullptr;
    if (!node->is_string()) fail(*node, key + " must be a string");
    value = node->as_string()->get();
    return node;
  }

  const toml::table* table(const std::string& key) {
    const toml::node* node = find(key);
    if (node && !node->is_table()) fail(*node, key + " must be a table");
    return node ? node->as_table() : nullptr;
  }

  void finish() const {
    for (const auto& [key, node] : table_) {
      if (known_.contains(std::string(key.str()))) continue;
      std::string known;
      for (const std::string& one : known_) known += (known.empty() ? "" : ", ") + one;
      throw ConfigurationError(key.source().begin.line, "unknown key '" + std::string(key.str()) + "'" +
                                                            name_ + " (known: " + known + ")");
    }
  }

 private:
  const toml::table& table_;
  std::string name_;
  std::set<std::string> known_;
};

void read_engine(const toml::table& table, EngineOptions& options) {
  TableReader reader(table, " in [engine]");
  reader.number("local_map_position_m", options.local_map.position_m, 0.01, 100);
  reader.number("local_map_yaw_rad", options.local_map.yaw_rad, 0.001, 3.2);
  reader.number("patch_spacing_m", options.patch_spacing_m, 0.05, 100);
  reader.number("patch_spacing_rad", options.patch_spacing_rad, 0.05, 6.3);
  reader.number("uncovered_share", options.uncovered_share, 0.01, 1);
  reader.number("free_space_range_m", options.patch.free_space.max_range_m, 0.5, 1000);
  reader.number("no_return_range_m", options.patch.free_space.no_return_range_m, 0, 1000);
  reader.finish();
}

void read_limits(const toml::table& table, EngineOptions& options) {
  TableReader reader(table, " in [limits]");
  auto patches = static_cast<std::int32_t>(options.patches_per_robot);
  reader.integer("patches_per_robot", patches, 1, 10'000'000);
  options.patches_per_robot = static_cast<std::size_t>(patches);
  reader.finish();
}

void read_laser(const toml::table& table, Laser& laser) {
  TableReader reader(table, " in laser");
  reader.number("x_m", laser.robot_from_laser.x, -100, 100);
  reader.number("y_m", laser.robot_from_laser.y, -100, 100);
  reader.number("yaw_rad", laser.robot_from_laser.yaw, -6.3, 6.3);
  reader.finish();
}

void read_channels(const toml::table& table, RobotConfiguration& robot) {
  TableReader reader(table, " in channels");
  for (const auto& [key, channel] : {std::pair{"odometry", &robot.odometry_channel},
                                     {"scan", &robot.scan_channel},
                                     {"sighting", &robot.sighting_channel}}) {
    const toml::node* node = reader.text(key, *channel);
    if (node && (channel->empty() || channel->size() > 63)) fail(*node, "a channel has 1 to 63 characters");
  }
  reader.finish();
}

MeasuredStart read_start(const toml::table& table, const std::string& robot) {
  TableReader reader(table, " in start");
  MeasuredStart start;
  if (!reader.text("with", start.with)) fail(table, "start needs 'with', the robot it is measured from");
  start.with = upper_case(start.with);
  if (!is_robot_name(start.with)) fail(table, "start.with must be a robot's name");
  if (start.with == robot) fail(table, "start.with must be another robot");
  reader.number("x", start.with_from_robot.x, -1e5, 1e5);
  reader.number("y", start.with_from_robot.y, -1e5, 1e5);
  reader.number("yaw", start.with_from_robot.yaw, -6.3, 6.3);
  reader.number("sigma_x", start.sigma.x(), 1e-4, 1e3);
  reader.number("sigma_y", start.sigma.y(), 1e-4, 1e3);
  reader.number("sigma_yaw", start.sigma.z(), 1e-4, 3.2);
  reader.finish();
  return start;
}

/// 0 says that the robot has no laser; range_min_m then says nothing.
bool read_range_max(TableReader& reader, double& range_max_m) {
  const toml::node* node = reader.find("range_max_m");
  if (!node || node->value<double>() != 0.0) return reader.number("range_max_m", range_max_m, 0.01, 1e5);
  range_max_m = 0;
  return true;
}

RobotConfiguration read_robot(const toml::table& table, const std::string& name) {
  TableReader reader(table, " of robot " + name);
  RobotConfiguration configuration;
  RobotEvent& robot = configuration.robot;
  robot.robot = name;
  bool described = reader.integer("barcode", robot.barcode, -1, std::numeric_limits<std::int32_t>::max());
  described |= reader.number("range_min_m", robot.laser.range_min_m, 0, 1e5);
  described |= read_range_max(reader, robot.laser.range_max_m);
  described |= reader.number("footprint_radius_m", robot.footprint_radius_m, 0, 100);
  if (robot.laser.range_max_m > 0 && robot.laser.range_min_m >= robot.laser.range_max_m)
    fail(table, "range_min_m must be below range_max_m");
  if (const toml::table* laser = reader.table("laser")) {
    read_laser(*laser, robot.laser);
    described = true;
  }
  if (const toml::table* channels = reader.table("channels")) read_channels(*channels, configuration);
  if (const toml::table* start = reader.table("start")) configuration.start = read_start(*start, name);
  reader.finish();
  configuration.declared = described || table.empty();
  return configuration;
}

/// Refuses barcodes and channels that two robots claim.
class UniqueClaims {
 public:
  void add(const RobotConfiguration& robot, const toml::node& at) {
    if (robot.robot.barcode >= 0) claim("barcode " + std::to_string(robot.robot.barcode), robot, at);
    for (const std::string& channel : {robot.odometry_channel, robot.scan_channel, robot.sighting_channel}) {
      if (!channel.empty()) claim("channel '" + channel + "'", robot, at);
    }
  }

 private:
  void claim(const std::string& thing, const RobotConfiguration& robot, const toml::node& at) {
    const auto [owner, is_new] = owners_.emplace(thing, robot.robot.robot);
    if (!is_new) fail(at, thing + " of robot " + robot.robot.robot + " is given already to " + owner->second);
  }

  std::map<std::string, std::string> owners_;
};

void read_robots(const toml::table& robots, Configuration& configuration) {
  UniqueClaims claims;
  for (const auto& [key, node] : robots) {
    const std::string name = upper_case(key.str());
    if (!is_robot_name(name)) {
      fail(node,
           "'" + std::string(key.str()) + "' is no robot name: letters, digits, '_' and '-', at most 48");
    }
    if (!node.is_table()) fail(node, "robot " + name + " must be a table: [robots." + name + "]");
    const auto [robot, is_new] = configuration.robots.emplace(name, read_robot(*node.as_table(), name));
    if (!is_new) fail(node, "robot " + name + " is given twice (names compare without case)");
    claims.add(robot->second, node);
  }
}

std::map<std::string, AuthKey> read_keys(const toml::table& keys, bool& withheld) {
  std::map<std::string, AuthKey> read;
  for (const auto& [name, node] : keys) {
    const std::string upper = upper_case(name.str());
    if (!is_robot_name(upper))
      fail(node, "'" + std::string(name.str()) + "' is no name: letters, digits, '_' and '-', at most 48");
    const auto text = node.value<std::string>();
    const bool empty = text && text->empty();
    const std::optional<AuthKey> key = empty ? AuthKey{} : parse_auth_key(text.value_or(""));
    if (!key) fail(node, "the key of " + upper + " must be 64 hexadecimal digits in quotes");
    if (!read.emplace(upper, *key).second) fail(node, upper + " is given twice (names compare without case)");
    withheld |= empty;
  }
  return read;
}

Authentication read_authentication(const toml::table& table) {
  TableReader reader(table, " in [auth]");
  Authentication authentication;
  if (const toml::table* robots = reader.table("robots"))
    authentication.robots = read_keys(*robots, authentication.withheld);
  if (const toml::table* operators = reader.table("operators"))
    authentication.operators = read_keys(*operators, authentication.withheld);
  reader.finish();
  for (const auto& [name, key] : authentication.operators) {
    if (authentication.robots.contains(name)) fail(table, name + " is both a robot and an operator");
  }
  if (!authentication.is_required()) fail(table, "[auth] without a key");
  return authentication;
}

Configuration read_configuration(const toml::table& table) {
  TableReader reader(table, "");
  Configuration configuration;
  std::string tags = "declared";
  if (const toml::node* node = reader.text("tags", tags); node && tags != "declared" && tags != "any") {
    fail(*node, "tags must be \"declared\" or \"any\"");
  }
  configuration.any_tag = tags == "any";
  if (const toml::table* engine = reader.table("engine")) read_engine(*engine, configuration.engine);
  if (const toml::table* limits = reader.table("limits")) read_limits(*limits, configuration.engine);
  if (const toml::table* robots = reader.table("robots")) read_robots(*robots, configuration);
  if (const toml::table* auth = reader.table("auth"))
    configuration.authentication = read_authentication(*auth);
  reader.finish();
  return configuration;
}

std::string text_of(const toml::table& table) {
  std::ostringstream text;
  text << table << "\n";
  return text.str();
}

std::string error_at(const std::string& file, std::int64_t line, const std::string& reason) {
  return file + ":" + std::to_string(line) + ": " + reason;
}

}  // namespace

std::variant<Configuration, std::string> parse_configuration(const std::string& toml,
                                                             const std::string& file) {
  if (toml.size() > most_toml_bytes) {
    return file + ": longer than " + std::to_string(most_toml_bytes) + " bytes";
  }
  try {
    Configuration configuration = read_configuration(toml::parse(toml, file));
    configuration.toml = toml;
    return configuration;
  } catch (const toml::parse_error& error) {
    return error_at(file, error.source().begin.line, std::string(error.description()));
  } catch (const ConfigurationError& error) {
    return error_at(file, error.line, error.what());
  }
}

std::string without_keys(const std::string& toml) {
  toml::table table = toml::parse(toml);
  toml::table* auth = table["auth"].as_table();
  if (auth == nullptr) return toml;
  for (auto&& [group, node] : *auth) {
    if (!node.is_table()) continue;
    for (auto&& [name, key] : *node.as_table()) {
      if (key.is_string()) *key.as_string() = "";
    }
  }
  return text_of(table);
}

bool map_alike(const std::string& toml, const std::string& other) {
  toml::table table = toml::parse(toml);
  toml::table other_table = toml::parse(other);
  table.erase("auth");
  other_table.erase("auth");
  return text_of(table) == text_of(other_table);
}

std::optional<AuthKey> parse_auth_key(const std::string& text) {
  AuthKey key{};
  if (text.size() != 2 * key.size()) return std::nullopt;
  for (std::size_t i = 0; i < key.size(); ++i) {
    const char* digits = text.data() + 2 * i;
    const auto [end, error] = std::from_chars(digits, digits + 2, key[i], 16);
    if (error != std::errc() || end != digits + 2) return std::nullopt;
  }
  return key;
}

}  // namespace isthmus
