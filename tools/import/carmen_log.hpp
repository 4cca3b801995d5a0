#pragma once

#include <optional>
#include <string>

#include "tools/import/carmen_line.hpp"
#include "tools/text/lines.hpp"

namespace isthmus {

/// Reads a CARMEN log line by line, plain or gz.
class CarmenReader {
 public:
  /// With `skip_bad_lines`, lines that cannot be read are counted and passed over, and a truncated gz ends
  /// where it was cut; otherwise either is a FileError.
  CarmenReader(const std::string& file, bool skip_bad_lines);

  /// The next odometry or laser line; nothing at the end.
  std::optional<CarmenLine> next();

  long bad_lines() const { return bad_lines_; }
  double progress() const { return lines_.progress(); }

 private:
  LineReader lines_;
  bool skip_bad_lines_;
  long bad_lines_ = 0;
};

/// What only the whole file tells.
struct CarmenFacts {
  std::int64_t first_utime = 0;  ///< of the first line that can be read
  long odometry_lines = 0;
  long scans = 0;
  long bad_lines = 0;
  std::optional<Pose> robot_from_laser;  ///< of the first ROBOTLASER1
  /// A range at or beyond it is no return: the largest value of the file where at least 0.1 % of the beams
  /// have it, or ROBOTLASER1's maximum range, whichever is less.
  std::optional<double> range_max_m;
};

/// Reads the whole log once. A file without odometry and laser lines is an error: no CARMEN log.
CarmenFacts survey_carmen_log(const std::string& file, bool skip_bad_lines);

}  // namespace isthmus
