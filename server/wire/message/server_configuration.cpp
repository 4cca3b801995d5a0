#include "server/wire/message/server_configuration.hpp"

#include <toml++/toml.h>
#include <charconv>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "server/engine/input/robot_name.hpp"
#include "server/engine/input/settings.hpp"
#include "server/program/spelling.hpp"

namespace isthmus {
namespace {

RobotChannels read_channels(const Setting& table) {
  Fields fields(table, " in channels");
  RobotChannels channels;
  for (const auto& [key, channel] : {std::pair{"odometry", &channels.odometry},
                                     {"scan", &channels.scan},
                                     {"sighting", &channels.sighting}}) {
    if (fields.read(key, *channel) && (channel->empty() || channel->size() > 63))
      fail_at(fields.where(key), "a channel has 1 to 63 characters");
  }
  fields.finish();
  return channels;
}

std::string channel_taken(const std::string& channel, const std::string& robot, const std::string& owner) {
  return "channel '" + channel + "' of robot " + robot + " is given already to " + owner;
}

/// Of the robots that name any; no two may have the same.
ChannelNames read_all_channels(const Setting& robots) {
  ChannelNames names;
  std::map<std::string, std::string> owners;
  for (const auto& [key, setting] : std::get<Setting::Table>(robots.value)) {
    const Setting* table = Fields(setting).table("channels");
    if (table == nullptr) continue;
    const std::string robot = upper_case(key);
    const RobotChannels& channels = names[robot] = read_channels(*table);
    for (const std::string& channel : {channels.odometry, channels.scan, channels.sighting}) {
      if (channel.empty()) continue;
      const auto [owner, is_free] = owners.emplace(channel, robot);
      if (!is_free) fail_at(setting.where, channel_taken(channel, robot, owner->second));
    }
  }
  return names;
}

std::map<std::string, AuthKey> read_keys(const Setting& keys, bool& withheld) {
  std::map<std::string, AuthKey> read;
  for (const auto& [name, setting] : std::get<Setting::Table>(keys.value)) {
    const std::string upper = upper_case(name);
    if (!is_robot_name(upper))
      fail_at(setting.where, "'" + name + "' is no name: letters, digits, '_' and '-', at most 48");
    const auto* text = std::get_if<std::string>(&setting.value);
    const bool empty = text != nullptr && text->empty();
    const std::optional<AuthKey> key = empty ? AuthKey{} : parse_auth_key(text != nullptr ? *text : "");
    if (!key) fail_at(setting.where, "the key of " + upper + " must be 64 hexadecimal digits in quotes");
    if (!read.emplace(upper, *key).second)
      fail_at(setting.where, upper + " is given twice (names compare without case)");
    withheld |= empty;
  }
  return read;
}

Authentication read_authentication(const Setting& table) {
  Fields fields(table, " in [auth]");
  Authentication authentication;
  if (const Setting* robots = fields.table("robots"))
    authentication.robots = read_keys(*robots, authentication.withheld);
  if (const Setting* operators = fields.table("operators"))
    authentication.operators = read_keys(*operators, authentication.withheld);
  fields.finish();
  for (const auto& [name, key] : authentication.operators) {
    if (authentication.robots.contains(name)) fail_at(table.where, name + " is both a robot and an operator");
  }
  if (!authentication.is_required()) fail_at(table.where, "[auth] without a key");
  return authentication;
}

ExplorationConfiguration read_exploration(const Setting& table) {
  Fields fields(table, " in [exploration]");
  ExplorationConfiguration exploration;
  fields.read("enabled", exploration.enabled);
  fields.read_within("clearance_m", exploration.clearance_m, 0, 1);
  fields.read_within("speed_m_s", exploration.speed_m_s, 0.01, 10);
  fields.read("search_place", exploration.search_place);
  fields.read_within("search_radius_m", exploration.search_radius_m, 0.1, 1000);
  fields.finish();
  return exploration;
}

void read_wire_parts(const Setting& root, ServerConfiguration& configuration) {
  Fields fields(root);
  if (const Setting* robots = fields.table("robots")) configuration.channels = read_all_channels(*robots);
  if (const Setting* auth = fields.table("auth")) configuration.authentication = read_authentication(*auth);
  if (const Setting* explore = fields.table("exploration"))
    configuration.exploration = read_exploration(*explore);
  std::string estimator(word(configuration.estimator));
  fields.read("estimator", estimator);
  if (const auto kind = value_of<EstimatorKind>(estimator))
    configuration.estimator = *kind;
  else
    fail_at(fields.where("estimator"), "estimator is manifold, segments or points" +
                                           did_you_mean(estimator, {"manifold", "segments", "points"}));
  if (configuration.exploration.enabled && configuration.estimator != EstimatorKind::manifold)
    fail_at(fields.where("exploration"), "robots are sent to explore on a manifold map only");
}

std::string text_of(const toml::table& table) {
  std::ostringstream text;
  text << table << "\n";
  return text.str();
}

}  // namespace

ServerConfiguration parse_server_configuration(const std::string& toml, const std::string& file) {
  auto engine = parse_configuration(toml, file);
  if (const std::string* error = std::get_if<std::string>(&engine)) throw std::runtime_error(*error);
  ServerConfiguration configuration;
  configuration.engine = std::get<Configuration>(std::move(engine));
  read_wire_parts(parse_settings(toml, file), configuration);
  return configuration;
}

ChannelNames channels_of(const Configuration& configuration) {
  try {
    return parse_server_configuration(configuration.toml, "configuration").channels;
  } catch (const std::runtime_error&) {
    return {};
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

std::string with_estimator(const std::string& toml, EstimatorKind estimator) {
  toml::table table = toml::parse(toml);
  const std::string name(word(estimator));
  const std::string given = table["estimator"].value_or(name);
  if (given != name) throw std::runtime_error("the configuration says estimator = \"" + given + "\"");
  table.insert_or_assign("estimator", name);
  return text_of(table);
}

bool map_alike(const std::string& toml, const std::string& other) {
  toml::table table = toml::parse(toml);
  toml::table other_table = toml::parse(other);
  for (toml::table* one : {&table, &other_table}) {
    for (const char* key : {"auth", "exploration"}) one->erase(key);
    one->insert_or_assign("estimator",
                          (*one)["estimator"].value_or(std::string(word(EstimatorKind::manifold))));
  }
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
