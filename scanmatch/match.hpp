#pragma once

#include <optional>
#include <span>
#include <vector>

#include "patches/option_unit.hpp"
#include "scanmatch/local_map.hpp"

namespace isthmus {

struct MatchOptions {
  double sigma_m = 0.03;
  double kernel_m = 0.04;
  double start_kernel_m = 0.2;
  double kernel_shrink = 0.6;
  double gate_kernels = 3;
  double min_gate_m = 0.1;
  int max_iterations = 20;
  int max_points = 250;
  int min_pairs = 12;
  double max_normal_angle_rad = 1.0;
  double thin_direction = 0.08;
  double pair_again_m = 0.01;
  double pair_again_rad = 0.003;
  double damping = 1e-3;
  double max_step_m = 0.3;
  double settled_m = 5e-4;
  double settled_rad = 2e-4;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(sigma_m, "sigma_m", "m", "standard deviation of a point's distance from the line it lies on");
    option(kernel_m, "kernel_m", "m", "scale of the robust loss at the end");
    option(start_kernel_m, "start_kernel_m", "m", "scale of the robust loss at the beginning");
    option(kernel_shrink, "kernel_shrink", "factor", "on that scale from one iteration to the next");
    option(gate_kernels, "gate_kernels", "factor",
           "pairs farther apart than so many scales of the loss are none");
    option(min_gate_m, "min_gate_m", "m", "pairs nearer than this are kept, whatever the scale of the loss");
    option(max_iterations, "max_iterations", "count", "of pairing and fitting");
    option(max_points, "max_points", "count",
           "of a scan, or of several, that are used; more are thinned evenly");
    option(min_pairs, "min_pairs", "count", "of beams: where fewer are paired there is no match");
    option(max_normal_angle_rad, "max_normal_angle_rad", "rad",
           "between the normals of two points that may be paired");
    option(thin_direction, "thin_direction", share_unit,
           "a direction of the plane with a smaller share f of the beams' information is held by a few beams "
           "only, which may well be wrong together (a corridor's door frames, somebody walking): it is "
           "trusted with a share f / √(f² + thin²) of their information");
    option(pair_again_m, "pair_again_m", "m",
           "beams are paired anew after so much motion; a tenth of the index's cell, so that few beams would "
           "have found another line");
    option(pair_again_rad, "pair_again_rad", "rad", "or after so much rotation");
    option(damping, "damping", "1/m²",
           "added to the diagonal of the normal equations: a direction that nothing holds must not move");
    option(max_step_m, "max_step_m", "m", "of one iteration; longer steps are shortened");
    option(settled_m, "settled_m", "m", "a shorter step, with less rotation than below, ends the fit");
    option(settled_rad, "settled_rad", "rad", "see settled_m");
  }
};

/// Where the robot is expected, and how surely.
struct Prediction {
  Pose local_from_robot;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< of (x, y, yaw); zero: any pose is as good
  std::optional<Pose> start = std::nullopt;               ///< where the fit begins, if not there
};

/// How far a match can be believed.
struct MatchQuality {
  double score = 0;         ///< mean robust weight over all beams used, 0 to 1
  double rms_m = 0;         ///< weighted RMS distance of paired beams from their lines
  int beams = 0;            ///< beams used
  int paired_beams = 0;     ///< of which paired with at least one patch
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
                 const MatchOptions& options);

}  // namespace isthmus
