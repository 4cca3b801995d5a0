#pragma once

namespace isthmus {

/// What makes pieces of wall one wall.
struct WallFitOptions {
  double agree_probability = 0.999;  ///< that two pieces of one wall are taken for one, by (α, ρ)
  double straight_sigma_m = 0.01;    ///< m: walls, and the map below them, are no straighter
  double straight_sigma_rad = 2e-3;  ///< rad
  double max_step_m = 0.08;          ///< m: what lies farther before or behind a wall is another one
  double max_turn_rad = 0.07;        ///< rad: what is turned by more is another one
  double max_gap_m = 3;              ///< m along a wall between pieces that are to be one line: a wide door
  int rounds = 3;                    ///< of giving each piece to the wall that it agrees with best
};

/// What of a wall's line is wall, and what is an opening.
struct StretchOptions {
  double bin_m = 0.1;           ///< m along the wall
  int min_views = 2;            ///< what fewer scans saw may be somebody who walked by,
  double lone_m = 0.5;          ///< m: unless one scan saw so much in one piece
  double pass_m = 0.2;          ///< m: a beam that ends so far behind the wall went through
  double min_incidence = 0.2;   ///< sine of its angle to the wall: flatter ones may have missed it
  double close_gap_m = 0.6;     ///< m: a shorter gap that no beam went through was hidden
  double min_wall_m = 0.3;      ///< m: shorter stretches are clutter
  double min_opening_m = 0.5;   ///< m
  double max_opening_m = 2.5;   ///< m
  double end_reach_m = 0.15;    ///< m within which ends that were found are one end
  double double_m = 0.1;        ///< m: a wall that lies within so much of one more often seen is that one
  double corner_reach_m = 0.8;  ///< m that a wall is drawn on to its corner where nobody looked through
};

struct PlanPoleOptions {
  double reach_m = 0.2;  ///< m between centres of what is one pole
  int min_views = 3;
};

/// How far a patch lies wrong among its neighbours: it is what tells two visits' walls apart.
struct PatchErrorOptions {
  double sigma_m = 0.01;
  double sigma_rad = 2e-3;
};

struct PlanOptions {
  WallFitOptions walls;
  StretchOptions stretches;
  PlanPoleOptions poles;
  PatchErrorOptions patch_error;
};

}  // namespace isthmus
