#pragma once

#include <optional>
#include <string>

#include "bot_core/planar_lidar_t.hpp"
#include "bot_core/pose_t.hpp"
#include "isthmus/annotation_t.hpp"
#include "isthmus/command_t.hpp"
#include "isthmus/configuration_t.hpp"
#include "isthmus/initial_pose_t.hpp"
#include "isthmus/robot_t.hpp"
#include "isthmus/sighting_t.hpp"
#include "isthmus/tag_t.hpp"
#include "isthmus/tick_t.hpp"
#include "server/engine/input/drop_reason.hpp"
#include "server/engine/input/event.hpp"

namespace isthmus {

using EventBody = decltype(Event::body);

/// A decoded message's meaning, or the reason why its values are not believed.
struct Reading {
  std::optional<EventBody> body;
  DropReason reason = DropReason::none;
};

/// Whether a stamp can be one: not negative, and exact as a double, so that no arithmetic on it overflows.
bool is_plausible_utime(std::int64_t utime);

/// Value checks and conversion of each input. `robot` is the channel's, upper case. A robot's range_max_m is
/// above its range_min_m, or exactly 0: it has no laser.
Reading read_message(const robot_t& message, const std::string& robot);
Reading read_message(const bot_core::pose_t& message, const std::string& robot);
Reading read_message(const bot_core::planar_lidar_t& message, const std::string& robot);
Reading read_message(const sighting_t& message, const std::string& robot);
Reading read_message(const tag_t& message, const std::string& robot);
Reading read_message(const command_t& message, const std::string& robot);
Reading read_message(const configuration_t& message, const std::string& robot);
Reading read_message(const tick_t& message, const std::string& robot);
Reading read_message(const annotation_t& message, const std::string& robot);
Reading read_message(const initial_pose_t& message, const std::string& robot);

}  // namespace isthmus
