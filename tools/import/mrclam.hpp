#pragma once

#include <span>
#include <string>
#include <vector>

#include "tools/import/import.hpp"
#include "tools/import/mrclam_files.hpp"

namespace isthmus {

/// How a UTIAS MRCLAM set is read. The defaults are measured on set 6, from the innovation of all 19,255
/// sightings of known barcodes by the five robots against motion capture (measured less true, truth
/// interpolated at the sighting's time; the 15 that are off by more than 1 m or 0.35 rad are left out: they
/// name the wrong barcode). The time offsets are those of least standard deviation.
struct MrclamImport {
  std::string directory;

  /// Range: 0.168 m RMS over all, bias −0.03 m; it grows with range, from 0.075 m RMS at 1 to 2 m to 0.25 m
  /// beyond 6 m. Of σ² = a² + (b·range)² these two are the most likely. Of two sightings of the same barcode
  /// the range errors are correlated by 0.95 within 0.5 s and still by 0.55 within 5 s.
  double range_std_m = 0.03;
  double range_std_share = 0.045;

  /// Bearing: 0.0112 rad RMS over all. Of single robots 0.007 to 0.010, and 0.019 for the first, whose camera
  /// has long tails; biases within 0.0023 rad but for the fourth, −0.0130 rad. They are part of the RMS and
  /// not taken off: a robot cannot know them.
  double bearing_std_rad = 0.0112;

  /// Odometry is what a robot was told, and it does so 0.20 s later (0.20 to 0.25 for each of the five: where
  /// the turning over 0.4 s agrees best; the difference falls to 52 to 65 %).
  double odometry_lag_s = 0.20;
  /// Sightings carry stamps 0.04 s after the picture (0.04 for each of the five; bearings then agree best).
  double sighting_lag_s = 0.04;

  /// A command is held until the next line but no longer than this. The longest gap of set 6 is 1.03 s, and
  /// through its 316 gaps of over 0.4 s the robots moved on at 81 to 95 % of what they were told.
  double longest_hold_s = 1.5;

  /// Without them each robot is on its own but for the landmarks: what the robots' sightings of one another
  /// are worth.
  bool robot_sightings = true;
};

/// Odometry poses at each line, from (0, 0, 0) at the first: a robot moves along an arc of a circle from one
/// line to the next. A stamp that runs back moves nothing.
std::vector<Pose> integrate_velocities(std::span<const VelocityLine> lines, double longest_hold_s);

/// Turns a set into events, merged as import_carmen does: robots R1 to R5 (without lasers, range_max_m = 0)
/// and the landmarks as tags, then odometry and sightings. Sightings of unknown barcodes stay in. Throws
/// FileError naming file, line and reason; all files are checked before the first event.
ImportReport import_mrclam(const MrclamImport& what, const std::function<void(const Event&)>& sink,
                           const std::function<void(double)>& progress = {});

std::vector<Event> import_mrclam(const MrclamImport& what);

/// Writes the set's ground truth as the simulator writes its own: ROBOT.tum, and tags.csv with
/// `barcode,x_m,y_m`. Throws FileError or std::runtime_error naming the file.
void write_mrclam_truth(const std::string& directory, const std::string& truth_directory);

}  // namespace isthmus
