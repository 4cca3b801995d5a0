#pragma once

#include <cstdint>
#include <vector>

#include "patches/option_unit.hpp"
#include "patches/pose.hpp"

namespace isthmus {

/// Where a robot's laser sits and what it can see.
struct Laser {
  Pose robot_from_laser;
  double range_min_m = 0.05;
  double range_max_m = 80;  ///< a range at or beyond it is "no return" (REP-117); 0: there is no laser
};

/// One planar laser scan as it came: beam i looks along bearing0_rad + i * bearing_step_rad in the laser's
/// frame. The step may be negative. utime in microseconds.
struct Scan {
  std::int64_t utime = 0;
  double bearing0_rad = 0;
  double bearing_step_rad = 0;
  std::vector<float> ranges_m;
};

/// What a single range says (lcmtypes/README.md).
enum class BeamKind {
  hit,        ///< an obstacle at that range
  no_return,  ///< +inf, or at least the maximum: at most weak evidence of free space
  ignored,    ///< below the minimum, NaN, -inf, 0
};
BeamKind classify(float range_m, const Laser& laser);

/// A beam's end, in the robot's frame, and the line through its neighbours.
struct ScanPoint {
  Eigen::Vector2d position;
  Eigen::Vector2d normal;  ///< of the line: unit, towards the laser; zero where none fits the neighbourhood
  std::int32_t beam = 0;
  float spread_m2 = 0;   ///< along the line: sum of its points' squared distances, m²
  float line_off_m = 0;  ///< of the line from `position`, along the normal
  float noise_m2 = 0;    ///< variance of `position` across the line, or of its range where there is none

  bool has_normal() const { return normal.squaredNorm() > 0.5; }
  /// Of a position, along the normal. The line is that of many points: to measure from one of them would take
  /// its noise, and of the points near a place those would be chosen whose noise has brought them there.
  double distance_from_line_m(const Eigen::Vector2d& at) const {
    return normal.dot(at - position) - line_off_m;
  }
};

/// Normals are fitted over an arc of the scan: the neighbours of a point, along the scan, that lie within
/// `half_width_m` of it without a jump. Normals from the very next beams only cost 1.4 cm of bias.
///
/// Where the ends of beams lie far apart, as on a wall that runs away from the laser, no neighbour may be
/// left out for its distance: noise would choose those that it has brought nearer, outward on one side and
/// inward on the other, and turn every such normal the same way. Maps made of them bend, by 2° in 100 m.
///
/// What stands out of a wall, as the frame of a door, shows a laser that looks along the wall the side that
/// faces it and hides the other. Lines through wall and frame lie behind both, by 1 cm at 4 m ahead, on
/// either side of a corridor: where the robot does not drive in the middle, its map bends, by 3° in 100 m. A
/// line at so flat an angle to its beam that is rougher than the laser's noise is therefore taken from the
/// neighbours on one side alone, if that one is not.
///
/// Ends of beams err along the beams; how far is what a scan itself shows (RangeNoise in scan.cpp), and with
/// it what is too fine for so few beams. A line is rough by that besides what its surface is. With one bound
/// on both, four of five lines of a laser that errs by 3 cm were none.
struct NormalOptions {
  double half_width_m = 0.30;
  double max_jump_m = 0.30;
  double max_flatness_m = 0.04;
  int min_points = 3;
  double min_elongation = 4;
  double reach_beams = 6;
  double most_gap_growth = 1.8;
  int sure_neighbours = 2;
  double grazing_sine = 0.5;
  double noise_sigmas = 3;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(half_width_m, "half_width_m", "m", "of the neighbours on either side that a normal is taken from");
    option(max_jump_m, "max_jump_m", "m", "neighbours farther apart than this are on different surfaces");
    option(max_flatness_m, "max_flatness_m", "m",
           "RMS distance of a surface from its line, besides the laser's noise, beyond which it has none");
    option(min_points, "min_points", "count", "of a line");
    option(min_elongation, "min_elongation", "factor",
           "between the variances along and across it, below which there is no normal");
    option(
        reach_beams, "reach_beams", "factor",
        "on the distance between beams' ends across the beams: far from the laser, neighbours may lie so far "
        "apart, as on a surface no flatter to the beams than 1 in so many");
    option(most_gap_growth, "most_gap_growth", "factor",
           "on the gaps beside it: a wider one is a shadow's, and behind it is another surface");
    option(sure_neighbours, "sure_neighbours", "count",
           "on either side that are taken however far they are, where there is no jump");
    option(grazing_sine, "grazing_sine", share_unit,
           "sine of a beam's angle to a surface, below which of what stands out of it one side is hidden");
    option(noise_sigmas, "noise_sigmas", "sigmas",
           "of the scan's noise: a line that is rougher than that goes through more than one surface");
  }
};

/// The hits of a scan as points in the robot's frame, in order of beams, with normals.
std::vector<ScanPoint> to_points(const Scan& scan, const Laser& laser, const NormalOptions& options);

}  // namespace isthmus
