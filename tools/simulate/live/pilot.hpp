#pragma once

#include <optional>
#include <vector>

#include "patches/scan.hpp"
#include "tools/simulate/live/steering.hpp"

namespace isthmus {

/// What a robot does by itself: it drives along a path that it was given, round what its laser sees, goes
/// back a little on the way that it came where another robot needs the place, and knows when it does not get
/// on. Its frame is that of its odometry.
class Pilot {
 public:
  Pilot(const DrivePlan& drive, double radius_m) : drive_(drive), radius_m_(radius_m) {}

  void note_odometry(const Pose& odom_from_robot, double time_s);
  void note_scan(const Scan& scan, const Laser& laser);
  /// Where the frame of the map that its path is in lies now.
  void localise(const Pose& odom_from_map) { odom_from_map_ = odom_from_map; }

  /// From where it is on; at the end it turns to a heading, where there is one. In the map's frame.
  void follow(std::vector<Eigen::Vector2d> map_path, std::optional<double> map_heading_rad);
  /// Back along the way that it came, so far; then it stands for a while.
  void back_off(double metres, double stand_s);
  void halt();

  /// It has a path, and is not at its end.
  bool is_driving() const { return !path_.empty(); }
  bool is_backing_off() const { return backing_off_ || now_s_ < stand_until_s_; }
  /// It came to the end of the last path that it was given.
  bool has_arrived() const { return arrived_; }
  /// For how long it has tried to get on and did not.
  double stuck_s() const { return is_driving() ? now_s_ - moved_s_ : 0; }

  /// What it does now.
  Motion drive();

 private:
  Eigen::Vector2d in_odometry(const Eigen::Vector2d& point) const;
  bool is_past_leg(const Eigen::Vector2d& here) const;
  Eigen::Vector2d target();
  void end_path();

  DrivePlan drive_;
  double radius_m_ = 0;
  double now_s_ = 0;
  Pose odom_from_robot_;
  Pose odom_from_map_;
  std::vector<Eigen::Vector2d> obstacles_;  // in the frame of odometry
  std::vector<Eigen::Vector2d> trail_;      // the same
  std::vector<Eigen::Vector2d> path_;       // in the map's frame, or that of odometry when it backs off
  std::optional<double> heading_rad_;
  std::size_t next_ = 0;
  bool backing_off_ = false;
  bool arrived_ = false;
  double stand_until_s_ = 0;
  double moved_s_ = 0;
  Eigen::Vector2d moved_from_ = Eigen::Vector2d::Zero();
};

}  // namespace isthmus
