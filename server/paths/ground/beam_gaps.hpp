#pragma once

#include <vector>

#include "patches/observation.hpp"

namespace isthmus {

/// A sector of a scan in which no beam tells anything, as none came back or a teammate's body was in its way
/// (NaN), between two that did: bearings in the laser's frame.
struct BeamGap {
  double from_rad = 0;
  double to_rad = 0;   ///< greater
  double range_m = 0;  ///< as far as it is no wider than `max_gap_m`, and both beams at its rims went
};

/// The gaps of a scan. Something as wide as a robot would have been hit by the beams at their rims: along a
/// narrow corridor whose end is out of the laser's range, all that a robot sees of the way ahead is such a
/// gap. A beam that met something nearer than the laser can measure makes none.
std::vector<BeamGap> find_beam_gaps(const Observation& seen);

/// Whether a point of the robot's frame lies in a gap.
bool lies_in(const BeamGap& gap, const Laser& laser, const Eigen::Vector2d& point_robot);

}  // namespace isthmus
