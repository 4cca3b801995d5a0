#pragma once

#include <span>
#include <vector>

#include "scanmatch/local_map.hpp"

namespace isthmus {

struct MatchOptions {
  double sigma_m = 0.03;        ///< distance of a point from the line it lies on
  double kernel_m = 0.04;       ///< scale of the robust loss at the end
  double start_kernel_m = 0.2;  ///< and at the beginning
  int max_iterations = 20;
  int max_points = 180;  ///< more are thinned evenly
  int min_pairs = 12;    ///< fewer beams paired than this: no match
  double max_normal_angle_rad = 1.0;
  /// A direction of the plane that gets less than this share of the beams' information is held by a few beams
  /// only, which may well be wrong together (a corridor's door frames, somebody walking): it is trusted by
  /// f² / (f² + thin²), f its share.
  double thin_direction = 0.03;
};

/// Where the robot is expected, and how surely.
struct Prediction {
  Pose local_from_robot;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< of (x, y, yaw); zero: any pose is as good
};

/// How far a match can be believed.
struct MatchQuality {
  double score = 0;         ///< mean robust weight over all beams used, 0 to 1
  double inlier_share = 0;  ///< beams within the kernel's scale of a line
  double rms_m = 0;         ///< weighted RMS distance of paired beams from their lines
  int beams = 0;            ///< beams used
  int paired_beams = 0;     ///< of which paired with at least one patch
  /// Information per paired beam of the least determined direction of the plane, 0 to about 0.5. Close to
  /// zero in a corridor.
  double weakest_direction = 0;
  bool degenerate = false;  ///< the beams leave a direction open: only the prediction holds it
};

/// A scan's point on a patch's line.
struct Pair {
  int patch = 0;      ///< index in the local map
  int point = 0;      ///< index in the scan's points
  int line = 0;       ///< index in the patch's points
  double weight = 0;  ///< robust weight, shared among the patches that the same beam is paired with
};

struct Match {
  bool ok = false;
  Pose local_from_robot;
  /// Of the beams alone, each counted once however many patches it is paired with; 1 / sigma².
  Eigen::Matrix3d beam_information = Eigen::Matrix3d::Zero();
  /// What the directions of the plane are trusted with, as a factor on the lines' normals (see
  /// thin_direction).
  Eigen::Matrix2d direction_trust = Eigen::Matrix2d::Identity();
  MatchQuality quality;
  std::vector<Pair> pairs;
};

/// Fits a scan to the local map (Howard et al. 2006, IV-A, steps 3 and 4): pairs each point with the nearest
/// point of each patch, and its line, and minimises the distances under a robust loss together with the
/// prediction (eq. 13), pairing and fitting in turn (EM style) while the loss narrows.
Match match_scan(const LocalMap& local_map, std::span<const ScanPoint> points, const Prediction& prediction,
                 const MatchOptions& options = {});

}  // namespace isthmus
