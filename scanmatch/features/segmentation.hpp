#pragma once

#include <span>
#include <vector>

#include "scanmatch/features/line_fit.hpp"

namespace isthmus {

struct SegmentationOptions {
  double jump_angle_rad =
      0.17;                 ///< rad: a surface is at no flatter angle to the beams (Borges and Aldon 2004)
  double jump_sigmas = 4;   ///< σ of both ranges that a jump exceeds besides
  int missing_beams = 2;    ///< so many without a hit do not end a surface: dropouts
  double worst_sigmas = 4;  ///< of a point from its line, beyond which the line is split: 1 in 16,000
  double chi_squared_per_point = 2.5;  ///< of a line: where all points are somewhat off, it is a curve
  double step_m = 0.01;                ///< m: no line is split for less, whatever the noise says
  double edge_m = 0.15;  ///< m that what is seen past an end lies behind the wall: a stray point does not
  int min_points = 4;    ///< of a line: two more than fit any
  double min_length_m = 0.25;  ///< m: shorter ones are clutter, and poorly known in direction
};

/// Points [first, last] of a scan.
struct PointRun {
  int first = 0;
  int last = 0;

  int size() const { return last - first + 1; }
};

/// Points of a scan on one line.
struct LineRun {
  PointRun points;
  Line line;
};

/// Stretches of a scan without jumps in range.
std::vector<PointRun> surfaces(std::span<const BeamPoint> points, double step_rad,
                               const SegmentationOptions& options);

/// The lines of one surface by split and merge: split at the point farthest from the chord until every piece
/// is straight to within its noise; neighbours that are one line joined again; the border between two lines
/// moved to where both fit best. In order of the scan; pieces too short or of too few points are left out.
std::vector<LineRun> lines_of(std::span<const BeamPoint> points, const PointRun& surface,
                              const SegmentationOptions& options);

}  // namespace isthmus
