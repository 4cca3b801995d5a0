#include "server/wire/message/read_message.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <numbers>
#include <utility>

#include "server/engine/annotations/annotations.hpp"
#include "server/engine/input/robot_name.hpp"

namespace isthmus {
namespace {

constexpr std::int64_t largest_utime = std::int64_t{1} << 53;
constexpr double largest_position_m = 1e6;
constexpr double largest_mount_m = 100;
constexpr double largest_footprint_m = 100;
constexpr double largest_range_m = 1e5;
constexpr double largest_angle_rad = 4 * std::numbers::pi;
constexpr double largest_speed_m_s = 100;
constexpr double largest_sigma_m = 10;
constexpr double smallest_step_rad = 1e-6;
constexpr double single_beam_step_rad = 0.01;
/// A full turn, and room for the rounding of a float step times thousands of beams.
constexpr double largest_field_of_view_rad = 2 * std::numbers::pi + 0.1;

Reading refused(DropReason reason) { return {std::nullopt, reason}; }

bool all_finite(std::initializer_list<double> values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

bool within(double value, double limit) { return std::abs(value) <= limit; }

/// range_max_m = 0 says that the robot has no laser; range_min_m then says nothing.
bool are_plausible_limits(double range_min_m, double range_max_m) {
  if (range_min_m < 0 || range_max_m > largest_range_m) return false;
  return range_max_m == 0 || range_min_m < range_max_m;
}

/// What is wrong with a scan's ranges; nothing where some beam hit something or came back empty. Single beams
/// may hold anything (REP-117): they are judged one by one, by the robot's limits.
DropReason check_ranges(const std::vector<float>& ranges) {
  if (ranges.empty()) return DropReason::zero_beams;
  if (std::any_of(ranges.begin(), ranges.end(), [](float r) { return r > 0; })) return DropReason::none;
  const bool any_number = std::any_of(ranges.begin(), ranges.end(), [](float r) { return std::isfinite(r); });
  return any_number ? DropReason::absurd_value : DropReason::not_finite;
}

/// What is wrong with a measured part of a sighting: a value and its sigma, +inf for "not measured".
DropReason check_measured(double value, double sigma, double min, double max) {
  if (std::isnan(sigma)) return DropReason::not_finite;
  if (sigma <= 0) return DropReason::absurd_value;
  if (std::isinf(sigma)) return DropReason::none;
  if (!std::isfinite(value)) return DropReason::not_finite;
  return value < min || value > max ? DropReason::absurd_value : DropReason::none;
}

/// What an order is about: a closure, a robot, or neither.
DropReason check_operand(Verb verb, std::int64_t closure, const std::string& robot) {
  const bool names_closure = closure >= 0 && closure <= std::numeric_limits<std::int32_t>::max();
  if (is_about_a_closure(verb)) return names_closure ? DropReason::none : DropReason::absurd_value;
  if (verb == Verb::allow)
    return names_closure || !robot.empty() ? DropReason::none : DropReason::absurd_value;
  if (verb == Verb::drop) return robot.empty() ? DropReason::bad_name : DropReason::none;
  return DropReason::none;
}

/// An id of an island or patch, or -1: none.
bool is_id_or_none(std::int32_t id) { return id >= -1; }

DropReason check_points(const annotation_t& message, AnnotationKind kind) {
  for (const annotation_point_t& point : message.points) {
    if (!all_finite({point.x, point.y})) return DropReason::not_finite;
    if (!within(point.x, largest_position_m) || !within(point.y, largest_position_m) ||
        !is_id_or_none(point.patch))
      return DropReason::absurd_value;
  }
  constexpr std::size_t min_corners = 3;
  if (is_zone(kind)) return message.points.size() < min_corners ? DropReason::bad_polygon : DropReason::none;
  const std::size_t points = kind == AnnotationKind::place ? 1 : 0;
  return message.points.size() == points ? DropReason::none : DropReason::absurd_value;
}

/// What is wrong with the numbers of an annotation of a kind.
DropReason check_values(const annotation_t& message, AnnotationKind kind) {
  if (!all_finite({message.max_speed, message.yaw})) return DropReason::not_finite;
  const bool has_speed = kind == AnnotationKind::speed;
  const bool plausible = is_plausible_utime(message.utime) && within(message.yaw, largest_angle_rad) &&
                         is_id_or_none(message.island) && message.max_speed <= largest_speed_m_s &&
                         (has_speed ? message.max_speed > 0 : message.max_speed == 0);
  return plausible ? check_points(message, kind) : DropReason::absurd_value;
}

}  // namespace

bool is_plausible_utime(std::int64_t utime) { return utime >= 0 && utime <= largest_utime; }

Reading read_message(const robot_t& message, const std::string& robot) {
  if (upper_case(message.name) != robot) return refused(DropReason::bad_name);
  if (!all_finite({message.laser_x_m, message.laser_y_m, message.laser_yaw_rad, message.range_min_m,
                   message.range_max_m, message.footprint_radius_m})) {
    return refused(DropReason::not_finite);
  }
  const bool plausible = is_plausible_utime(message.utime) && within(message.laser_x_m, largest_mount_m) &&
                         within(message.laser_y_m, largest_mount_m) &&
                         within(message.laser_yaw_rad, largest_angle_rad) &&
                         are_plausible_limits(message.range_min_m, message.range_max_m) &&
                         message.footprint_radius_m >= 0 && message.footprint_radius_m <= largest_footprint_m;
  if (!plausible) return refused(DropReason::absurd_value);
  RobotEvent event;
  event.robot = robot;
  event.utime = message.utime;
  event.barcode = message.barcode;
  event.laser = {{message.laser_x_m, message.laser_y_m, message.laser_yaw_rad},
                 message.range_min_m,
                 message.range_max_m};
  event.footprint_radius_m = message.footprint_radius_m;
  event.restarted = message.restarted != 0;
  return {std::move(event)};
}

Reading read_message(const bot_core::pose_t& message, const std::string& robot) {
  const auto& [w, x, y, z] = message.orientation;
  if (!all_finite({message.pos[0], message.pos[1], w, x, y, z})) return refused(DropReason::not_finite);
  if (!is_plausible_utime(message.utime) || !within(message.pos[0], largest_position_m) ||
      !within(message.pos[1], largest_position_m) || !within(w, 2) || !within(x, 2) || !within(y, 2) ||
      !within(z, 2)) {
    return refused(DropReason::absurd_value);
  }
  // The rotated x axis, of a quaternion that need not be quite of unit length.
  const double forward_x = w * w + x * x - y * y - z * z;
  const double forward_y = 2 * (x * y + w * z);
  if (std::hypot(forward_x, forward_y) < 0.1) return refused(DropReason::absurd_value);
  return {OdometryEvent{
      robot, message.utime, {message.pos[0], message.pos[1], std::atan2(forward_y, forward_x)}}};
}

Reading read_message(const bot_core::planar_lidar_t& message, const std::string& robot) {
  if (const DropReason reason = check_ranges(message.ranges); reason != DropReason::none)
    return refused(reason);
  if (!all_finite({message.rad0, message.radstep})) return refused(DropReason::not_finite);
  const double bearing0_rad = message.rad0;
  // One beam has no step: some say 0.
  const bool no_step = message.ranges.size() == 1 && message.radstep == 0;
  const double step_rad = no_step ? single_beam_step_rad : double{message.radstep};
  const double field_of_view_rad = std::abs(step_rad) * static_cast<double>(message.ranges.size() - 1);
  if (!is_plausible_utime(message.utime) || !within(bearing0_rad, largest_angle_rad) ||
      std::abs(step_rad) < smallest_step_rad || field_of_view_rad > largest_field_of_view_rad) {
    return refused(DropReason::absurd_value);
  }
  return {ScanEvent{robot, {message.utime, bearing0_rad, step_rad, message.ranges}}};
}

Reading read_message(const sighting_t& message, const std::string& robot) {
  for (const DropReason reason : {check_measured(message.range_m, message.range_sigma_m, 0, largest_range_m),
                                  check_measured(message.bearing_rad, message.bearing_sigma_rad,
                                                 -largest_angle_rad, largest_angle_rad)}) {
    if (reason != DropReason::none) return refused(reason);
  }
  const bool nothing_measured = std::isinf(message.range_sigma_m) && std::isinf(message.bearing_sigma_rad);
  if (!is_plausible_utime(message.utime) || message.barcode < 0 || nothing_measured) {
    return refused(DropReason::absurd_value);
  }
  SightingEvent event{robot,
                      message.utime,
                      message.barcode,
                      message.range_m,
                      message.range_sigma_m,
                      message.bearing_rad,
                      message.bearing_sigma_rad};
  if (std::isinf(event.range_sigma_m)) event.range_m = 0;
  if (std::isinf(event.bearing_sigma_rad)) event.bearing_rad = 0;
  return {std::move(event)};
}

Reading read_message(const tag_t& message, const std::string&) {
  if (!is_plausible_utime(message.utime) || message.barcode < 0) return refused(DropReason::absurd_value);
  return {TagEvent{message.utime, message.barcode}};
}

Reading read_message(const command_t& message, const std::string&) {
  const std::optional<Verb> verb = value_of<Verb>(message.verb);
  if (!verb) return refused(DropReason::unknown_command);
  const std::string robot = upper_case(message.robot);
  if (!robot.empty() && !is_robot_name(robot)) return refused(DropReason::bad_name);
  if (!is_plausible_utime(message.utime)) return refused(DropReason::absurd_value);
  const DropReason reason = check_operand(*verb, message.closure, robot);
  if (reason != DropReason::none) return refused(reason);
  return {CommandEvent{message.utime, *verb, message.closure, robot}};
}

Reading read_message(const annotation_t& message, const std::string&) {
  const std::optional<AnnotationKind> kind = value_of<AnnotationKind>(message.kind);
  if (!kind) return refused(DropReason::unknown_command);
  if (!is_annotation_name(message.name)) return refused(DropReason::bad_name);
  if (const DropReason reason = check_values(message, *kind); reason != DropReason::none)
    return refused(reason);
  AnnotationEvent event;
  event.utime = message.utime;
  event.kind = *kind;
  event.name = message.name;
  event.replace = message.replace != 0;
  event.max_speed_m_s = message.max_speed;
  event.yaw_rad = message.yaw;
  event.island = IslandId{message.island};
  for (const annotation_point_t& point : message.points)
    event.points.push_back({PatchId{point.patch}, {point.x, point.y}});
  return {std::move(event)};
}

Reading read_message(const initial_pose_t& message, const std::string& robot) {
  const auto& [x, y, yaw] = message.pose;
  if (!all_finite({x, y, yaw, message.sigma_m, message.sigma_rad})) return refused(DropReason::not_finite);
  const bool plausible = is_plausible_utime(message.utime) && within(x, largest_position_m) &&
                         within(y, largest_position_m) && within(yaw, largest_angle_rad) &&
                         message.sigma_m > 0 && message.sigma_m <= largest_sigma_m && message.sigma_rad > 0 &&
                         message.sigma_rad <= std::numbers::pi && is_id_or_none(message.island) &&
                         is_id_or_none(message.patch);
  if (!plausible) return refused(DropReason::absurd_value);
  InitialPoseEvent event;
  event.robot = robot;
  event.utime = message.utime;
  event.island = IslandId{message.island};
  event.patch = PatchId{message.patch};
  event.pose = {x, y, yaw};
  event.sigma_m = message.sigma_m;
  event.sigma_rad = message.sigma_rad;
  return {std::move(event)};
}

Reading read_message(const configuration_t& message, const std::string&) {
  return {ConfigurationEvent{message.toml}};
}

Reading read_message(const tick_t&, const std::string&) { return {TickEvent{}}; }

}  // namespace isthmus
