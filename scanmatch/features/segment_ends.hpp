#pragma once

#include <optional>

#include "scanmatch/features/scan_features.hpp"

namespace isthmus {

/// A line of a scan with the lines that it meets, if any.
struct LineInScan {
  LineRun run;
  std::optional<Line> before;  ///< the wall that it meets on its right, at its first point
  std::optional<Line> after;   ///< on its left
};

/// What surrounds the lines of a scan.
struct ScanAround {
  std::span<const BeamPoint> points;
  double step_rad = 0;  ///< positive
  int beams = 0;
  double range_max_m = 0;
};

/// The line as a segment in the laser's frame: its ends told apart, each real one with its covariance. A
/// corner's end is where both lines meet; the other wall is a measurement of its own, so its share of the
/// variance is made nine times as large, lest one wall's points count twice. An edge is somewhere between two
/// beams, evenly.
ScanSegment segment_of(const LineInScan& line, const ScanAround& around, const SegmentationOptions& options);

}  // namespace isthmus
