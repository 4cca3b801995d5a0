#include "tools/simulate/scenario/robot_file.hpp"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <limits>

namespace isthmus {
namespace {

constexpr double largest = 1e9;
constexpr int max_laps = 1'000'000'000;

Pose as_pose_degrees(const Setting& setting) {
  const auto n = as_numbers(setting, 3, "[x, y, yaw] in metres and degrees");
  return {n[0], n[1], wrap_angle(n[2] * std::numbers::pi / 180)};
}

void read_laser(const Setting* setting, LaserPlan& plan) {
  if (setting == nullptr) return;
  Fields fields(*setting);
  fields.read_within("beams", plan.beams, 1, 20000);
  fields.read_degrees("field_of_view_deg", plan.field_of_view_rad);
  fields.read_within("rate_hz", plan.rate_hz, 0, 1000);
  fields.read_within("range_min_m", plan.laser.range_min_m, 0, 1000);
  fields.read_within("range_max_m", plan.laser.range_max_m, 0.1, 1000);
  fields.read_within("range_sigma_m", plan.range_sigma_m, 0, 10);
  fields.read_within("bearing_sigma_rad", plan.bearing_sigma_rad, 0, 1);
  fields.read_within("dropout_share", plan.dropout_share, 0, 1);
  fields.read_within("no_return_share", plan.no_return_share, 0, 1);
  fields.read("interlaced", plan.interlaced);
  fields.read_degrees("return_limit_deg", plan.return_limit_rad);
  fields.read("no_return_is_infinite", plan.no_return_is_infinite);
  fields.read_within("scan_lag_s", plan.scan_lag_s, -10, 10);
  if (const Setting* mount = fields.find("mount")) plan.laser.robot_from_laser = as_pose_degrees(*mount);
  if (const Setting* error = fields.find("mount_error")) plan.declared_mount_error = as_pose_degrees(*error);
  fields.finish();
}

void read_odometry(const Setting* setting, OdometryPlan& plan) {
  if (setting == nullptr) return;
  Fields fields(*setting);
  fields.read_within("rate_hz", plan.rate_hz, 0.1, 1000);
  fields.read_within("linear_share", plan.linear_share, 0, 10);
  fields.read_within("angular_share", plan.angular_share, 0, 10);
  fields.read_within("angular_floor_rps", plan.angular_floor_rps, 0, 10);
  fields.read_within("noise_period_s", plan.noise_period_s, 1e-3, largest);
  fields.read_within("linear_scale", plan.linear_scale, -1e4, 1e4);
  fields.read_within("angular_scale", plan.angular_scale, -1e4, 1e4);
  fields.read_within("linear_scale_sigma", plan.linear_scale_sigma, 0, 1);
  fields.read_within("angular_scale_sigma", plan.angular_scale_sigma, 0, 1);
  fields.read_within("curvature_rpm", plan.curvature_rpm, -10, 10);
  fields.finish();
}

void read_camera(const Setting* setting, CameraPlan& plan) {
  if (setting == nullptr) return;
  Fields fields(*setting);
  fields.read_within("rate_hz", plan.rate_hz, 0, 1000);
  fields.read_within("from_s", plan.from_s, 0, largest);
  fields.read_within("range_max_m", plan.range_max_m, 0, 1000);
  fields.read_degrees("field_of_view_deg", plan.field_of_view_rad);
  fields.read_within("range_sigma_m", plan.range_sigma_m, 0, 100);
  fields.read_within("bearing_sigma_rad", plan.bearing_sigma_rad, 0, 10);
  fields.read_within("detection_share", plan.detection_share, 0, 1);
  fields.finish();
}

void read_drive(const Setting* setting, DrivePlan& plan) {
  if (setting == nullptr) return;
  Fields fields(*setting);
  fields.read_within("speed_mps", plan.speed_mps, 0.01, 50);
  fields.read_within("acceleration_mps2", plan.acceleration_mps2, 0.01, 100);
  fields.read_within("turn_rate_rps", plan.turn_rate_rps, 0.01, 50);
  fields.read_within("lookahead_m", plan.lookahead_m, 0.05, 10);
  fields.read_within("waypoint_jitter_m", plan.waypoint_jitter_m, 0, 10);
  fields.finish();
}

TourStep read_step(const Setting& setting) {
  if (std::holds_alternative<Setting::List>(setting.value)) return Waypoint{as_point(setting)};
  Fields fields(setting);
  if (fields.has("wait_s")) {
    Wait wait;
    fields.read_within("wait_s", wait.seconds, 0, largest);
    fields.finish();
    return wait;
  }
  Carry carry;
  carry.world_from_robot = as_pose_degrees(fields.require("carry_to"));
  fields.read_within("carry_s", carry.seconds, 0, largest);
  fields.read("odometry_restarts", carry.odometry_restarts);
  fields.read("announced", carry.announced);
  fields.finish();
  return carry;
}

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(),
                         [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

}  // namespace

RobotPlan read_common(Fields& scenario) {
  RobotPlan common;
  scenario.read_within("laps", common.laps, 0, max_laps);
  read_laser(scenario.find("laser"), common.laser);
  read_odometry(scenario.find("odometry"), common.odometry);
  read_camera(scenario.find("camera"), common.camera);
  read_drive(scenario.find("drive"), common.drive);
  return common;
}

RobotFromFile read_robot(const std::string& name, const Setting& setting, const RobotPlan& common) {
  Fields fields(setting);
  RobotFromFile robot{common, {}};
  RobotPlan& plan = robot.plan;
  plan.name = upper(name);
  const bool has_tour = !common.tour.empty();
  const auto find = [&](const char* key) { return has_tour ? fields.find(key) : &fields.require(key); };
  if (const Setting* start = find("start")) plan.start = as_pose_degrees(*start);
  fields.read_within("barcode", plan.barcode, -1, std::numeric_limits<std::int32_t>::max());
  fields.read_within("laps", plan.laps, 0, max_laps);
  fields.read("silent", plan.silent);
  fields.read_within("start_s", plan.start_s, 0, largest);
  fields.read_within("radius_m", plan.radius_m, 0.01, 10);
  if (const Setting* freezes = fields.find("freezes")) {
    for (const Setting& freeze : as_list(*freezes, "a list of [from, to] in seconds")) {
      const auto n = as_numbers(freeze, 2, "[from, to] in seconds of the run");
      plan.freezes.push_back({n[0], n[1]});
    }
  }
  read_laser(fields.find("laser"), plan.laser);
  read_odometry(fields.find("odometry"), plan.odometry);
  read_camera(fields.find("camera"), plan.camera);
  read_drive(fields.find("drive"), plan.drive);
  if (const Setting* tour = find("tour")) {
    plan.tour.clear();
    for (const Setting& step : as_list(*tour, "a list of steps")) {
      plan.tour.push_back(read_step(step));
      robot.step_where.push_back(step.where);
    }
  }
  fields.finish();
  return robot;
}

}  // namespace isthmus
