#pragma once

#include "tools/simulate/plan/random.hpp"
#include "tools/simulate/scenario/scenario.hpp"

namespace isthmus {

/// Dead reckoning with the errors of an OdometryPlan; its frame is where it was last restarted.
class OdometryModel {
 public:
  OdometryModel(const OdometryPlan& plan, Random random);

  /// The robot moved; returns odom_from_robot at the later pose. dt_s > 0.
  Pose advance(const Pose& world_from_earlier, const Pose& world_from_later, double dt_s);
  void restart() { odom_from_robot_ = {}; }
  const Pose& pose() const { return odom_from_robot_; }

 private:
  OdometryPlan plan_;
  Random random_;
  double linear_scale_ = 1;
  double angular_scale_ = 1;
  double linear_noise_ = 0;  ///< standard normal, of this noise period
  double angular_noise_ = 0;
  double period_left_s_ = 0;
  Pose odom_from_robot_;
};

}  // namespace isthmus
