#include "tools/simulate/run/unicycle.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tools/simulate/plan/random.hpp"

namespace isthmus {
namespace {

using Eigen::Vector2d;

constexpr double step_s = TruePath::step_s;
constexpr double arrival_m = 0.05;
constexpr double sharp_rad = 1.8;         // corners beyond it are turned on the spot
constexpr double turn_on_spot_rad = 0.7;  // off course by more than that, the robot stands and turns
constexpr double turn_gain_per_s = 2.5;
constexpr double turned_rad = 0.02;  // so near to what it was to turn by, a robot is done
constexpr double turn_acceleration_rps2 = 3;

// One straight way of a polyline.
struct Way {
  Vector2d from, direction;
  double length;
};

class Driver {
 public:
  Driver(const RobotPlan& robot, std::vector<Pose>& poses)
      : robot_(robot), poses_(poses), pose_(poses.back()) {}

  void stand(double seconds) {
    for (double t = 0; t < seconds; t += step_s) move(0, 0);
  }

  void turn(double angle_rad) {
    double left_rad = angle_rad;
    while (std::abs(left_rad) > turned_rad) {
      const double before = pose_.yaw, most = robot_.drive.turn_rate_rps;
      move(0, std::clamp(turn_gain_per_s * left_rad, -most, most));
      left_rad -= wrap_angle(pose_.yaw - before);
    }
    stop();
  }

  void follow(const std::vector<Vector2d>& waypoints) {
    std::vector<Way> ways;
    Vector2d from = position(pose_);
    for (const Vector2d& to : waypoints) {
      const double length = (to - from).norm();
      if (length > 0.01) {
        ways.push_back({from, (to - from) / length, length});
        from = to;
      }
    }
    for (std::size_t i = 0; i < ways.size(); ++i)
      drive_way(ways[i], i + 1 < ways.size() ? &ways[i + 1] : nullptr);
    stop();
  }

 private:
  void drive_way(const Way& way, const Way* next) {
    const bool ends_here = next == nullptr || way.direction.dot(next->direction) < std::cos(sharp_rad);
    const double lookahead = robot_.drive.lookahead_m;
    const double leave_at = ends_here ? arrival_m : 0.5 * lookahead;
    const auto patience = static_cast<std::size_t>((60 + 20 * way.length / robot_.drive.speed_mps) / step_s);
    for (std::size_t steps = 0;; ++steps) {
      if (steps > patience) throw std::runtime_error(robot_.name + " cannot follow its tour");
      const double along = std::max(0.0, (position(pose_) - way.from).dot(way.direction));
      const double remaining = way.length - along;
      if (remaining < leave_at) return;
      Vector2d target = way.from + std::min(way.length, along + lookahead) * way.direction;
      if (!ends_here && remaining < lookahead) target += (lookahead - remaining) * next->direction;
      steer(target, ends_here ? remaining : 1e9);
    }
  }

  void steer(const Vector2d& target, double stop_within_m) {
    const Vector2d ahead = target - position(pose_);
    const double error = wrap_angle(std::atan2(ahead.y(), ahead.x()) - pose_.yaw);
    double speed = 0;
    if (std::abs(error) < turn_on_spot_rad) {
      const double braking = std::sqrt(2 * robot_.drive.acceleration_mps2 * stop_within_m) + 0.02;
      speed = std::min(robot_.drive.speed_mps * std::cos(error) * std::cos(error), braking);
    }
    const double most = robot_.drive.turn_rate_rps;
    move(speed, std::clamp(turn_gain_per_s * error, -most, most));
  }

  void stop() {
    while (speed_ > 0 || turn_rate_ != 0) move(0, 0);
  }

  void move(double wanted_speed, double wanted_turn_rate) {
    const double push = robot_.drive.acceleration_mps2 * step_s;
    const double twist = turn_acceleration_rps2 * step_s;
    speed_ = std::clamp(wanted_speed, speed_ - 2 * push, speed_ + push);
    turn_rate_ = std::clamp(wanted_turn_rate, turn_rate_ - twist, turn_rate_ + twist);
    const double heading = pose_.yaw + 0.5 * turn_rate_ * step_s;
    pose_ = {pose_.x + speed_ * step_s * std::cos(heading), pose_.y + speed_ * step_s * std::sin(heading),
             wrap_angle(pose_.yaw + turn_rate_ * step_s)};
    poses_.push_back(pose_);
  }

  const RobotPlan& robot_;
  std::vector<Pose>& poses_;
  Pose pose_;
  double speed_ = 0;
  double turn_rate_ = 0;
};

// The waypoint moved at random, at most half as far as the walls beside its ways allow.
Vector2d jittered(const Waypoint& waypoint, const RobotPlan& robot, Random& random) {
  const double room = std::max(0.0, 0.5 * (waypoint.clearance_m - robot.radius_m - 0.05));
  Vector2d offset(random.normal(robot.drive.waypoint_jitter_m), random.normal(robot.drive.waypoint_jitter_m));
  if (offset.norm() > room) offset *= room / offset.norm();
  return waypoint.position + offset;
}

}  // namespace

double PathStretch::end_s() const {
  return start_s + TruePath::step_s * static_cast<double>(world_from_robot.size() - 1);
}

std::optional<std::size_t> TruePath::stretch_at(double time_s) const {
  for (std::size_t i = stretches_.size(); i-- > 0;) {
    if (time_s < stretches_[i].start_s) continue;
    const bool last = i + 1 == stretches_.size();
    return last || time_s <= stretches_[i].end_s() ? std::optional(i) : std::nullopt;
  }
  return std::nullopt;
}

Pose TruePath::at(std::size_t stretch, double time_s) const {
  const PathStretch& s = stretches_[stretch];
  const double steps =
      std::clamp((time_s - s.start_s) / step_s, 0.0, static_cast<double>(s.world_from_robot.size() - 1));
  const auto i = static_cast<std::size_t>(steps);
  const Pose& a = s.world_from_robot[i];
  const Pose& b = s.world_from_robot[std::min(i + 1, s.world_from_robot.size() - 1)];
  const double share = steps - static_cast<double>(i);
  return {a.x + share * (b.x - a.x), a.y + share * (b.y - a.y),
          wrap_angle(a.yaw + share * wrap_angle(b.yaw - a.yaw))};
}

std::optional<Pose> TruePath::at(double time_s) const {
  const auto stretch = stretch_at(time_s);
  return stretch ? std::optional(at(*stretch, time_s)) : std::nullopt;
}

TruePath drive(const RobotPlan& robot, std::uint64_t seed) {
  Random random(seed, robot.name + " waypoints");
  std::vector<PathStretch> stretches{{robot.start_s, {robot.start}, true, true}};
  std::vector<Vector2d> ahead;
  const auto go = [&](double stand_s, double turn_rad = 0) {
    Driver driver(robot, stretches.back().world_from_robot);
    driver.follow(ahead);
    driver.turn(turn_rad);
    driver.stand(stand_s);
    ahead.clear();
  };
  for (int lap = 0; lap < robot.laps; ++lap) {
    for (const TourStep& step : robot.tour) {
      if (const auto* waypoint = std::get_if<Waypoint>(&step)) {
        ahead.push_back(jittered(*waypoint, robot, random));
      } else if (const auto* wait = std::get_if<Wait>(&step)) {
        go(wait->seconds);
      } else if (const auto* turn = std::get_if<Turn>(&step)) {
        go(0, turn->angle_rad);
      } else {
        const auto& carry = std::get<Carry>(step);
        go(1);
        const double start_s = stretches.back().end_s() + std::max(carry.seconds, 2 * step_s);
        stretches.push_back({start_s, {carry.world_from_robot}, carry.odometry_restarts, carry.announced});
      }
    }
  }
  go(1);
  return TruePath(std::move(stretches));
}

}  // namespace isthmus
