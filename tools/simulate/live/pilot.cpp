#include "tools/simulate/live/pilot.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "patches/scan.hpp"

namespace isthmus {
namespace {

constexpr double far_ahead_m = 1.0;  // on the path, that it steers to
constexpr double arrival_m = 0.25;   // from its end
constexpr double arrival_rad = 0.3;  // of the heading there
constexpr double moved_m = 0.15;     // less is not getting on
constexpr double hesitates_s = 3;    // a robot that does not get on for so long
constexpr double hesitant_share =
    0.4;  // steers to a point so much nearer, and lets walls come so much nearer
constexpr double margin_m = 0.05;
constexpr double trail_spacing_m = 0.1;
constexpr std::size_t max_trail = 200;

}  // namespace

void Pilot::note_odometry(const Pose& odom_from_robot, double time_s) {
  odom_from_robot_ = odom_from_robot;
  now_s_ = time_s;
  const Eigen::Vector2d here = position(odom_from_robot);
  if ((here - moved_from_).norm() > moved_m || !is_driving()) {
    moved_from_ = here;
    moved_s_ = time_s;
  }
  if (!trail_.empty() && (trail_.back() - here).norm() < trail_spacing_m) return;
  trail_.push_back(here);
  if (trail_.size() > 2 * max_trail)
    trail_.erase(trail_.begin(), trail_.end() - static_cast<std::ptrdiff_t>(max_trail));
}

void Pilot::note_scan(const Scan& scan, const Laser& laser) {
  obstacles_.clear();
  for (const ScanPoint& point : to_points(scan, laser, {}))
    obstacles_.push_back(odom_from_robot_ * point.position);
}

void Pilot::follow(std::vector<Eigen::Vector2d> map_path, double map_heading_rad) {
  path_ = std::move(map_path);
  heading_rad_ = map_heading_rad;
  next_ = 0;
  backing_off_ = arrived_ = false;
}

void Pilot::back_off(double metres, double stand_s) {
  path_.clear();
  double length = 0;
  for (std::size_t i = trail_.size(); i-- > 1 && length < metres;) {
    length += (trail_[i] - trail_[i - 1]).norm();
    path_.push_back(trail_[i - 1]);
  }
  heading_rad_.reset();
  next_ = 0;
  backing_off_ = !path_.empty();
  arrived_ = false;
  moved_s_ = now_s_;
  stand_until_s_ = now_s_ + metres / drive_.speed_mps + stand_s;
}

void Pilot::halt() {
  path_.clear();
  backing_off_ = arrived_ = false;
}

Eigen::Vector2d Pilot::in_odometry(const Eigen::Vector2d& point) const {
  return backing_off_ ? point : Eigen::Vector2d(odom_from_map_ * point);
}

/// A point of the path some way ahead of where the robot is beside it.
Eigen::Vector2d Pilot::target() {
  const Eigen::Vector2d here = position(odom_from_robot_);
  double left_m = stuck_s() < hesitates_s ? far_ahead_m : hesitant_share * far_ahead_m;
  const auto share_of = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return (here - a).dot(b - a) / std::max(1e-9, (b - a).squaredNorm());
  };
  while (next_ + 1 < path_.size() && share_of(in_odometry(path_[next_]), in_odometry(path_[next_ + 1])) >= 1)
    ++next_;
  Eigen::Vector2d at = in_odometry(path_[next_]);
  for (std::size_t i = next_; i + 1 < path_.size(); ++i) {
    const Eigen::Vector2d end = in_odometry(path_[i + 1]);
    if (i == next_) at += std::clamp(share_of(at, end), 0.0, 1.0) * (end - at);
    const double length_m = (end - at).norm();
    if (length_m > left_m) return at + (end - at) * (left_m / length_m);
    left_m -= length_m;
    at = end;
  }
  return at;
}

void Pilot::end_path() {
  arrived_ = !backing_off_;
  backing_off_ = false;
  path_.clear();
}

Motion Pilot::drive() {
  if (!is_driving() || (!backing_off_ && now_s_ < stand_until_s_)) return {};
  const Pose robot_from_odom = inverse(odom_from_robot_);
  const Eigen::Vector2d end = robot_from_odom * in_odometry(path_.back());
  if (end.norm() <= arrival_m) {
    const double error =
        heading_rad_ ? wrap_angle(*heading_rad_ + odom_from_map_.yaw - odom_from_robot_.yaw) : 0;
    if (std::abs(error) <= arrival_rad) {
      end_path();
      return {};
    }
    moved_s_ = now_s_;
    return {0, std::clamp(2 * error, -drive_.turn_rate_rps, drive_.turn_rate_rps)};
  }
  std::vector<Eigen::Vector2d> obstacles;
  for (const Eigen::Vector2d& obstacle : obstacles_) obstacles.push_back(robot_from_odom * obstacle);
  const double margin = stuck_s() < hesitates_s ? margin_m : hesitant_share * margin_m;
  return steer(drive_, radius_m_, robot_from_odom * target(), obstacles, margin);
}

}  // namespace isthmus
