#pragma once

#include <span>
#include <tuple>
#include <vector>

#include "scanmatch/local_map.hpp"

namespace isthmus {

/// The box of poses to search: half widths about a centre.
struct SearchWindow {
  Pose centre;  ///< local_from_robot
  double half_x_m = 0.5;
  double half_y_m = 0.5;
  double half_yaw_rad = 0.35;

  auto members() { return std::tie(centre, half_x_m, half_y_m, half_yaw_rad); }
};

/// A second answer with this share of the best one's score: who knows which it is. At 0.95 aliased corridors
/// of real logs get in.
inline constexpr double ambiguous_share = 0.88;

struct CorrelativeOptions {
  double cell_m = 0.1;
  double yaw_step_rad = 0.0175;
  double blur_m = 0.1;  ///< standard deviation of the fit's fall around a point of the map
  double reach_m = 12;  ///< beams that end farther away are left out
  int max_points = 90;
  double apart_m = 0.5;           ///< a second answer is at least so far from the best in position
  double apart_rad = 0.26;        ///< or in yaw
  double second_share = 0.8;      ///< answers below this share of the best are not looked for
  double least_score = 0;         ///< nor those below this
  long max_evaluations = 40'000;  ///< of all beams at one pose; when spent, the best so far is returned
};

struct CorrelativeResult {
  Pose local_from_robot;
  double score = 0;         ///< mean over the beams of a fit from 0 to 1
  double second_score = 0;  ///< of the best answer well apart from it, 0: none near the best: the ambiguity
  Pose second_local_from_robot;  ///< that answer, where there is one
  bool exhausted = false;        ///< the cap on work was reached
  long evaluations = 0;          ///< the work it took
};

/// Correlative search by branch and bound over a pyramid of maximum grids: the pose of the window at which
/// the beams' ends fall best on the local map's points. For predictions too uncertain for match_scan to start
/// from.
CorrelativeResult search_window(const LocalMap& local_map, std::span<const ScanPoint> points,
                                const SearchWindow& window, const CorrelativeOptions& options = {});

/// The same in a map that is but points, given in `local`.
CorrelativeResult search_window(std::span<const Eigen::Vector2d> local_points,
                                std::span<const ScanPoint> points, const SearchWindow& window,
                                const CorrelativeOptions& options = {});

}  // namespace isthmus
