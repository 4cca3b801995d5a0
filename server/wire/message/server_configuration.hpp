#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "server/engine/input/configuration.hpp"
#include "server/engine/input/words.hpp"

namespace isthmus {

/// The channels that a robot sends on; empty: <ROBOT>_ODOMETRY, and so on.
struct RobotChannels {
  std::string odometry;
  std::string scan;
  std::string sighting;
};

/// By upper-case name of the robot; one that is not listed has the default channels.
using ChannelNames = std::map<std::string, RobotChannels>;

using AuthKey = std::array<std::uint8_t, 32>;

/// Who signs messages, by upper-case name, and with which key. Where there are any, nobody else is believed.
struct Authentication {
  std::map<std::string, AuthKey> robots;
  std::map<std::string, AuthKey> operators;
  bool withheld = false;  ///< some key is "", as in the configuration that a journal holds

  bool is_required() const { return !robots.empty() || !operators.empty(); }
};

/// Whether and how the server lets robots explore.
struct ExplorationConfiguration {
  bool enabled = false;
  double clearance_m = 0.1;  ///< that ways keep from walls, more than a robot's radius
  double speed_m_s = 0.5;    ///< at which robots are taken to drive
  std::string search_place;  ///< the name of a place around which is explored first; empty: none
  double search_radius_m = 5;
};

/// What makes the map.
enum class EstimatorKind : std::uint8_t { manifold, segments, points };

template <>
inline constexpr auto words_of<EstimatorKind> = std::to_array<std::string_view>({"manifold", "segments",
                                                                                 "points"});

/// A configuration file: what the engine takes of it, and what concerns the wire alone.
struct ServerConfiguration {
  Configuration engine;
  ChannelNames channels;
  Authentication authentication;
  ExplorationConfiguration exploration;
  EstimatorKind estimator = EstimatorKind::manifold;
};

/// Reads all parts of a configuration. Throws std::runtime_error naming `file`, the line and the reason.
ServerConfiguration parse_server_configuration(const std::string& toml, const std::string& file);

/// The channels in the text of a configuration that an engine has; none where it names them wrongly.
ChannelNames channels_of(const Configuration& configuration);

/// A configuration's text with its keys made empty, so that it can be shown; the text itself where it has
/// none. It must parse.
std::string without_keys(const std::string& toml);

/// A configuration's text with the estimator that it is to name. Throws std::runtime_error where it names
/// another. It must parse.
std::string with_estimator(const std::string& toml, EstimatorKind estimator);

/// Whether two configurations' texts say the same, but for who signs and who explores. Both must parse.
bool map_alike(const std::string& toml, const std::string& other);

/// 64 hexadecimal digits; nothing for anything else.
std::optional<AuthKey> parse_auth_key(const std::string& text);

}  // namespace isthmus
