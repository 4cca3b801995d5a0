#pragma once

#include <cstdint>
#include <string>

#include "tools/simulate/run/simulation.hpp"

namespace isthmus {

/// What is wrong with odometry beyond the noise of an OdometryPlan, as real logs have it. A fast turn is one
/// of more than 0.6 rad/s.
struct WheelFaults {
  double slip_chance = 0;    ///< of each fast turn
  double slip_share = 0;     ///< of what is turned then, lost or added, at most
  double told_rps = 0;       ///< what turns faster is reported later; 0: all is reported at once
  double freeze_chance = 0;  ///< of each fast turn: odometry repeats itself, then jumps to where it should be
  double freeze_s = 0;       ///< for so long at most
  double freezes_per_min = 0;  ///< whatever the robot does
  double jumps_per_min = 0;    ///< the heading jumps, and stays there
  double jump_rad = 0;         ///< by so much at most
  double lag_s = 0;            ///< odometry tells where the robot was so long ago
  double jitter_s = 0;         ///< stamps are off by so much at most, those of scan and odometry alike
};

/// Puts the faults into what a robot of the run tells; its truth gets the stamps that its scans have then.
void spoil_wheels(SimulatedRun& run, const std::string& robot, const WheelFaults& faults, std::uint64_t seed);

}  // namespace isthmus
