#pragma once

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
};

/// What the engine takes of the server's configuration; keys and channels are the wire's. Everything has a
/// default; no key is needed for any log.
struct Configuration {
  EngineOptions engine;
  std::map<std::string, RobotConfiguration> robots;  ///< by upper-case name
  bool any_tag = false;                              ///< tags = "any": undeclared barcodes are fixed tags
  std::string toml;                                  ///< the text it came from
};

/// Reads a TOML configuration; the parts of the wire are passed over. An error names `file`, the line and the
/// reason ("robots.toml:12: unknown key 'barcod'").
std::variant<Configuration, std::string> parse_configuration(const std::string& toml,
                                                             const std::string& file);

}  // namespace isthmus
