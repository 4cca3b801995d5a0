#include "tools/simulate/live/live_robot.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace isthmus {
namespace {

constexpr double wheel_turn_acceleration_rps2 = 4;

}  // namespace

LiveRobot::LiveRobot(const RobotPlan& plan, const Pose& world_from_robot, std::uint64_t seed,
                     std::int64_t start_utime)
    : plan_(plan),
      start_utime_(start_utime),
      world_from_robot_(world_from_robot),
      odometry_(plan.odometry, Random(seed, plan.name + " odometry")),
      laser_random_(seed, plan.name + " laser"),
      camera_random_(seed, plan.name + " camera") {}

std::int64_t LiveRobot::utime(double time_s) const { return start_utime_ + std::llround(1e6 * time_s); }

bool LiveRobot::move(const Motion& wanted, double dt_s, const RayCaster& caster) {
  const double push = plan_.drive.acceleration_mps2 * dt_s, twist = wheel_turn_acceleration_rps2 * dt_s;
  motion_.speed_mps = std::clamp(wanted.speed_mps, motion_.speed_mps - 2 * push, motion_.speed_mps + push);
  motion_.turn_rate_rps =
      std::clamp(wanted.turn_rate_rps, motion_.turn_rate_rps - twist, motion_.turn_rate_rps + twist);
  const Pose before = world_from_robot_;
  const double heading = before.yaw + 0.5 * dt_s * motion_.turn_rate_rps, by_m = dt_s * motion_.speed_mps;
  Pose after{before.x + by_m * std::cos(heading), before.y + by_m * std::sin(heading),
             wrap_angle(before.yaw + dt_s * motion_.turn_rate_rps)};
  const bool free = !caster.touches(position(after), plan_.radius_m);
  if (!free) {
    after.x = before.x;
    after.y = before.y;
    motion_.speed_mps = 0;
  }
  world_from_robot_ = after;
  driven_m_ += (position(after) - position(before)).norm();
  odometry_.advance(before, after, dt_s);
  return free;
}

RobotEvent LiveRobot::introduction(double time_s) const {
  return {plan_.name, utime(time_s), plan_.barcode, declared_laser(plan_.laser), plan_.radius_m, false};
}

OdometryEvent LiveRobot::odometry(double time_s) const {
  return {plan_.name, utime(time_s), odometry_.pose()};
}

ScanEvent LiveRobot::scan(double time_s, const RayCaster& caster, const std::vector<Passerby>& bodies) {
  ScanEvent event{plan_.name, take_scan(plan_.laser, caster, world_from_robot_, bodies, laser_random_)};
  event.scan.utime = utime(time_s);
  return event;
}

std::optional<SightingEvent> LiveRobot::look(double time_s, const RayCaster& caster,
                                             const Eigen::Vector2d& target, int barcode) {
  if (barcode < 0 || !in_sight(plan_.camera, caster, world_from_robot_, target)) return std::nullopt;
  if (!camera_random_.chance(plan_.camera.detection_share)) return std::nullopt;
  SightingEvent event =
      measure(plan_.camera, true_sighting(world_from_robot_, target, barcode), camera_random_);
  event.robot = plan_.name;
  event.utime = utime(time_s);
  return event;
}

}  // namespace isthmus
