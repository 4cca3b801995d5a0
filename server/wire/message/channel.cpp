#include "server/wire/message/channel.hpp"

#include <array>
#include <utility>

#include "server/engine/input/robot_name.hpp"

namespace isthmus {
namespace {

constexpr std::array<std::pair<std::string_view, Input>, 5> robot_suffixes = {
    {{"_ROBOT", Input::robot},
     {"_ODOMETRY", Input::odometry},
     {"_SCAN", Input::scan},
     {"_SIGHTING", Input::sighting},
     {"_INITIAL_POSE", Input::initial_pose}}};

constexpr std::array<std::pair<std::string_view, Input>, 5> common_channels = {
    {{"ISTHMUS_TAG", Input::tag},
     {"ISTHMUS_COMMAND", Input::command},
     {"ISTHMUS_ANNOTATION", Input::annotation},
     {"ISTHMUS_CONFIGURATION", Input::configuration},
     {"ISTHMUS_TICK", Input::tick}}};

/// The channel that the configuration gives a robot's input; empty: the default.
const std::string& configured_channel(const RobotChannels& robot, Input input) {
  static const std::string none;
  switch (input) {
    case Input::odometry:
      return robot.odometry;
    case Input::scan:
      return robot.scan;
    case Input::sighting:
      return robot.sighting;
    default:
      return none;
  }
}

bool has_other_channel(const ChannelNames& configured, const Channel& channel) {
  const auto robot = configured.find(channel.robot);
  return robot != configured.end() && !configured_channel(robot->second, channel.input).empty();
}

}  // namespace

std::optional<Channel> find_channel(const ChannelNames& configured, const std::string& name) {
  for (const auto& [robot, channels] : configured) {
    for (const Input input : {Input::odometry, Input::scan, Input::sighting}) {
      if (!name.empty() && configured_channel(channels, input) == name) return Channel{input, robot, true};
    }
  }
  const std::string upper = upper_case(name);
  for (const auto& [common, input] : common_channels) {
    if (upper == common) return Channel{input, "", true};
  }
  for (const auto& [suffix, input] : robot_suffixes) {
    if (!upper.ends_with(suffix)) continue;
    Channel channel{input, upper.substr(0, upper.size() - suffix.size()), true};
    channel.valid = is_robot_name(channel.robot);
    if (!channel.valid) channel.robot.clear();
    if (has_other_channel(configured, channel)) return std::nullopt;
    return channel;
  }
  return std::nullopt;
}

bool is_request_channel(const std::string& name) { return upper_case(name) == request_channel; }

std::string default_channel(Input input, const std::string& robot) {
  for (const auto& [suffix, suffix_input] : robot_suffixes) {
    if (suffix_input == input) return robot + std::string(suffix);
  }
  for (const auto& [common, common_input] : common_channels) {
    if (common_input == input) return std::string(common);
  }
  return "";
}

}  // namespace isthmus
