#include "tools/simulate/live/pilot.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "patches/scan.hpp"
#include "patches/segment.hpp"

namespace isthmus {
namespace {

constexpr double far_ahead_m = 1.0;  // on the path, that it steers to,
constexpr double near_ahead_m = 0.3;
constexpr double corner_m = 0.06;  // but not past a corner that it would cut by more
constexpr double ahead_step_m = 0.1;
constexpr double at_end_m = 0.25;      // from its end
constexpr double at_end_rad = 0.3;     // of the heading there
constexpr double getting_on_m = 0.15;  // less is not getting on
constexpr double hesitates_s = 3;      // a robot that does not get on for so long
constexpr double hesitant_share =
    0.4;  // steers to a point so much nearer, and lets walls come so much nearer
constexpr double driving_margin_m = 0.05;
constexpr double trail_spacing_m = 0.1;
constexpr std::size_t max_trail = 200;

}  // namespace

void Pilot::note_odometry(const Pose& odom_from_robot, double time_s) {
  odom_from_robot_ = odom_from_robot;
  now_s_ = time_s;
  const Eigen::Vector2d here = position(odom_from_robot);
  if ((here - moved_from_).norm() > getting_on_m || !is_driving()) {
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

void Pilot::follow(std::vector<Eigen::Vector2d> map_path, std::optional<double> map_heading_rad) {
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

/// Whether the next leg of the path is as near as the one that it is on.
bool Pilot::is_past_leg(const Eigen::Vector2d& here) const {
  const Eigen::Vector2d a = in_odometry(path_[next_]), b = in_odometry(path_[next_ + 1]),
                        c = in_odometry(path_[next_ + 2]);
  return distance_to_segment_m(here, b, c) <= distance_to_segment_m(here, a, b);
}

/// The farthest point of the path some way ahead to which it can go straight without cutting a corner.
Eigen::Vector2d Pilot::target() {
  const Eigen::Vector2d here = position(odom_from_robot_);
  const double most_m = stuck_s() < hesitates_s ? far_ahead_m : hesitant_share * far_ahead_m;
  const auto share_of = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return (here - a).dot(b - a) / std::max(1e-9, (b - a).squaredNorm());
  };
  while (next_ + 2 < path_.size() && is_past_leg(here)) ++next_;
  Eigen::Vector2d at = in_odometry(path_[next_]);
  if (next_ + 1 < path_.size()) {
    const Eigen::Vector2d end = in_odometry(path_[next_ + 1]);
    at += std::clamp(share_of(at, end), 0.0, 1.0) * (end - at);
  }
  const double beside_m = std::max(corner_m, (at - here).norm());
  std::vector<Eigen::Vector2d> corners;
  const auto is_cut = [&](const Eigen::Vector2d& to) {
    return std::ranges::any_of(
        corners, [&](const auto& corner) { return distance_to_segment_m(corner, here, to) > beside_m; });
  };
  double ahead_m = 0;
  for (std::size_t i = next_; i + 1 < path_.size(); ++i) {
    const Eigen::Vector2d end = in_odometry(path_[i + 1]), by = end - at;
    for (double length_m = by.norm(), along_m = 0; along_m < length_m;) {
      const double step_m = std::min(ahead_step_m, length_m - along_m);
      const Eigen::Vector2d next = end - by * ((length_m - along_m - step_m) / length_m);
      if (ahead_m + step_m > most_m || ((at - here).norm() >= near_ahead_m && is_cut(next))) return at;
      at = next;
      along_m += step_m;
      ahead_m += step_m;
    }
    corners.push_back(end);
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
  if (end.norm() <= at_end_m) {
    const double error =
        heading_rad_ ? wrap_angle(*heading_rad_ + odom_from_map_.yaw - odom_from_robot_.yaw) : 0;
    if (std::abs(error) <= at_end_rad) {
      end_path();
      return {};
    }
    moved_s_ = now_s_;
    return {0, std::clamp(2 * error, -drive_.turn_rate_rps, drive_.turn_rate_rps)};
  }
  std::vector<Eigen::Vector2d> obstacles;
  for (const Eigen::Vector2d& obstacle : obstacles_) obstacles.push_back(robot_from_odom * obstacle);
  const double margin = stuck_s() < hesitates_s ? driving_margin_m : hesitant_share * driving_margin_m;
  return steer(drive_, radius_m_, robot_from_odom * target(), obstacles, margin);
}

}  // namespace isthmus
