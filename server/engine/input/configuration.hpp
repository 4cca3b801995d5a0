#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "server/engine/input/engine_options.hpp"
#include "server/engine/input/event.hpp"

namespace isthmus {

/// A team mate that starts at a measured place (`start` in isthmus.example.toml).
struct MeasuredStart {
  std::string with;  ///< the robot whose start is the reference
  Pose with_from_robot;
  Eigen::Vector3d sigma = {0.05, 0.05, 0.02};
};

struct RobotConfiguration {
  RobotEvent robot;       ///< as if the robot had said it
  bool declared = false;  ///< barcode, mount and so on were given, not only channels
  std::optional<MeasuredStart> start;
  std::string odometry_channel;  ///< empty: <ROBOT>_ODOMETRY, and so on
  std::string scan_channel;
  std::string sighting_channel;
};

using AuthKey = std::array<std::uint8_t, 32>;

/// Who signs messages, by upper-case name, and with which key. Where there are any, nobody else is believed.
struct Authentication {
  std::map<std::string, AuthKey> robots;
  std::map<std::string, AuthKey> operators;
  bool withheld = false;  ///< some key is "", as in the configuration that a journal holds

  bool is_required() const { return !robots.empty() || !operators.empty(); }
};

/// The server's configuration. Everything has a default; no key is needed for any log.
struct Configuration {
  EngineOptions engine;
  std::map<std::string, RobotConfiguration> robots;  ///< by upper-case name
  bool any_tag = false;                              ///< tags = "any": undeclared barcodes are fixed tags
  Authentication authentication;
  std::string toml;  ///< the text it came from
};

/// Reads a TOML configuration. An error names `file`, the line and the reason ("robots.toml:12: unknown key
/// 'barcod'").
std::variant<Configuration, std::string> parse_configuration(const std::string& toml,
                                                             const std::string& file);

/// A configuration's text with its keys made empty, so that it can be shown; the text itself where it has
/// none. It must parse.
std::string without_keys(const std::string& toml);

/// Whether two configurations' texts say the same, but for who signs. Both must parse.
bool map_alike(const std::string& toml, const std::string& other);

/// 64 hexadecimal digits; nothing for anything else.
std::optional<AuthKey> parse_auth_key(const std::string& text);

}  // namespace isthmus
