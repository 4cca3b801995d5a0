#pragma once

#include <span>
#include <tuple>
#include <vector>

#include "patches/option_unit.hpp"
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

struct AmbiguityOptions {
  double share = 0.88;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(share, "share", share_unit,
           "of the best answer's score: with a second one above it, who knows which it is. At 0.95 aliased "
           "corridors of recorded logs get in");
  }
};

struct CorrelativeOptions {
  double cell_m = 0.1;
  double yaw_step_rad = 0.0175;
  double blur_m = 0.1;
  double blur_sigmas = 2.5;
  double reach_m = 24;
  int max_points = 90;
  double apart_m = 0.5;
  double apart_rad = 0.26;
  double second_share = 0.8;
  long max_evaluations = 40'000;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(cell_m, "cell_m", "m", "side of a cell of the grid, and step of the search in x and y");
    option(yaw_step_rad, "yaw_step_rad", "rad", "step of the search in yaw");
    option(blur_m, "blur_m", "m", "standard deviation of the fit's fall around a point of the map");
    option(blur_sigmas, "blur_sigmas", "sigmas", "beyond which the fit counts as 0");
    option(
        reach_m, "reach_m", "m",
        "beams that end farther away are left out; wide streets have their walls 13 m away, and by no beams "
        "nothing is found");
    option(max_points, "max_points", "count", "of the scan that are used; more are thinned evenly");
    option(apart_m, "apart_m", "m", "a second answer is at least so far from the best in position,");
    option(apart_rad, "apart_rad", "rad", "or so far in yaw");
    option(second_share, "second_share", share_unit,
           "of the best score, below which no answers are looked for");
    option(max_evaluations, "max_evaluations", "count",
           "of all beams at one pose: when spent, the best answer so far is returned");
  }
};

struct CorrelativeResult {
  Pose local_from_robot;
  double score = 0;         ///< mean over the beams of a fit from 0 to 1
  double second_score = 0;  ///< of the best answer well apart from it, 0: none near the best: the ambiguity
  Pose second_local_from_robot;  ///< that answer, where there is one
  bool exhausted = false;        ///< the cap on work was reached
  long evaluations = 0;          ///< the work it took
};

/// The ends of the beams that are searched for: within reach, thinned evenly.
std::vector<Eigen::Vector2d> searched_beams(std::span<const ScanPoint> points,
                                            const CorrelativeOptions& options);

/// How far they reach, in metres: no grid need reach farther. Whole cells, so that grids about one place have
/// their cells in the same places for all scans.
double reach_of(std::span<const Eigen::Vector2d> beams, const CorrelativeOptions& options);

/// Correlative search by branch and bound over a pyramid of maximum grids: the pose of the window at which
/// the beams' ends fall best on the local map's points. For predictions too uncertain for match_scan to start
/// from.
CorrelativeResult search_window(const LocalMap& local_map, std::span<const ScanPoint> points,
                                const SearchWindow& window, const CorrelativeOptions& options);

/// The same in a map that is but points, given in `local`. Answers below `min_score` are not looked for.
CorrelativeResult search_window(std::span<const Eigen::Vector2d> local_points,
                                std::span<const ScanPoint> points, const SearchWindow& window,
                                const CorrelativeOptions& options, double min_score = 0);

}  // namespace isthmus
