#pragma once

#include <Eigen/Core>
#include <string>
#include <variant>
#include <vector>

#include "server/engine/input/event.hpp"

namespace isthmus {

/// A closure's id as it stands in report.json. Throws std::runtime_error for anything else.
std::int64_t parse_closure_id(const std::string& text);

/// A robot's name, in upper case. Throws std::runtime_error where it cannot be one.
std::string parse_robot_name(const std::string& text);

/// What `allow` takes back: the withdrawal of a closure where the text is a number, the drop of a robot
/// otherwise.
CommandEvent allow_order(const std::string& text);

/// Any order that a network takes.
using Order = std::variant<CommandEvent, AnnotationEvent, InitialPoseEvent>;

/// Points of "1,2 3,-4.5": x,y in metres, with a space between two. Throws std::runtime_error for anything
/// else.
std::vector<Eigen::Vector2d> parse_points(const std::string& text);

/// A pose of "x,y" or "x,y,yaw", metres and degrees. Throws std::runtime_error for anything else.
Pose parse_pose(const std::string& text);

/// A name of a place or zone. Throws std::runtime_error where it cannot be one.
std::string parse_annotation_name(const std::string& text);

/// "forbid closure 3", "drop robot R1", "refine", "keep_out Stairs", "initial_pose robot R1"
std::string to_text(const Order& order);

}  // namespace isthmus
