#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "server/engine/input/event.hpp"
#include "tools/simulate/live/steering.hpp"
#include "tools/simulate/run/laser_model.hpp"
#include "tools/simulate/run/odometry_model.hpp"
#include "tools/simulate/run/sighting_model.hpp"

namespace isthmus {

/// A robot in a simulated building that goes where it is told to, as it goes: wheels, laser and camera with
/// their errors. Times in seconds of the run.
class LiveRobot {
 public:
  LiveRobot(const RobotPlan& plan, const Pose& world_from_robot, std::uint64_t seed,
            std::int64_t start_utime);

  /// Moves on with bounded acceleration; a robot that would touch a surface stands still and says so.
  /// Returns whether it is free to go.
  bool move(const Motion& wanted, double dt_s, const RayCaster& caster);

  const RobotPlan& plan() const { return plan_; }
  const Pose& world_from_robot() const { return world_from_robot_; }
  const Pose& odom_from_robot() const { return odometry_.pose(); }
  double driven_m() const { return driven_m_; }

  RobotEvent introduction(double time_s) const;
  OdometryEvent odometry(double time_s) const;
  ScanEvent scan(double time_s, const RayCaster& caster, const std::vector<Passerby>& bodies);
  /// A barcode somewhere; nothing where it is not in sight, or was not read.
  std::optional<SightingEvent> look(double time_s, const RayCaster& caster, const Eigen::Vector2d& target,
                                    int barcode);

 private:
  std::int64_t utime(double time_s) const;

  RobotPlan plan_;
  std::int64_t start_utime_;
  Pose world_from_robot_;
  OdometryModel odometry_;
  Random laser_random_, camera_random_;
  Motion motion_;
  double driven_m_ = 0;
};

}  // namespace isthmus
