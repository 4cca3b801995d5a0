#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tools/simulate/scenario/scenario.hpp"

namespace isthmus {

/// A time in which a robot is on its wheels: from when it is put down until it is carried away.
struct PathStretch {
  double start_s = 0;
  std::vector<Pose> world_from_robot;  ///< a pose every TruePath::step_s
  bool odometry_restarts = false;      ///< at its beginning
  bool announced = false;

  double end_s() const;
};

/// Where a robot was, at any time of the run.
class TruePath {
 public:
  static constexpr double step_s = 0.02;

  explicit TruePath(std::vector<PathStretch> stretches) : stretches_(std::move(stretches)) {}

  const std::vector<PathStretch>& stretches() const { return stretches_; }
  /// When its tour is done; it stands where it is from then on.
  double end_s() const { return stretches_.back().end_s(); }
  /// Index of the stretch of a time; none before the robot starts and while it is carried.
  std::optional<std::size_t> stretch_at(double time_s) const;
  /// world_from_robot; a time outside the stretch is clamped to it.
  Pose at(std::size_t stretch, double time_s) const;
  std::optional<Pose> at(double time_s) const;

 private:
  std::vector<PathStretch> stretches_;
};

/// Drives a robot's tour as a unicycle with bounded speed, turn rate and acceleration, after a point that
/// runs ahead of it along its way (pure pursuit); at sharp corners it stops and turns. `seed` varies the
/// waypoints. Throws std::runtime_error where a tour cannot be driven.
TruePath drive(const RobotPlan& robot, std::uint64_t seed);

}  // namespace isthmus
