#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/wire/message/server_configuration.hpp"

namespace isthmus {

/// What Isthmus takes from channels (lcmtypes/README.md). Configuration and tick are found in journals
/// only, never taken from the network.
enum class Input {
  robot,
  odometry,
  scan,
  sighting,
  tag,
  command,
  configuration,
  tick,
  annotation,
  initial_pose,
};

/// Whose message a channel carries, and which.
struct Channel {
  Input input = Input::robot;
  std::string robot;  ///< upper case; empty for inputs of no robot
  bool valid = true;  ///< false: it ends like an input, but what comes before cannot be a robot's name
};

/// Nothing for a channel that is not an input. A channel named in the configuration is that robot's, as
/// written; its default channel is then not read. Otherwise case does not count.
std::optional<Channel> find_channel(const ChannelNames& configured, const std::string& name);

/// The channel an input has when the configuration says nothing else.
std::string default_channel(Input input, const std::string& robot);

/// Questions about the map, and what is said to them: no input, as they are none of the engine's.
inline constexpr const char* request_channel = "ISTHMUS_REQUEST";
inline constexpr const char* reply_channel = "ISTHMUS_REPLY";
/// Case does not count, as with inputs.
bool is_request_channel(const std::string& name);

}  // namespace isthmus
