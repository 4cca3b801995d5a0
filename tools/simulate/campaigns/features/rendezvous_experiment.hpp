#pragma once

#include <cstdint>
#include <vector>

#include "server/features/fusion/fusion.hpp"

namespace isthmus {

/// What Zhou and Roumeliotis (2006) do not tell of their experiment.
struct RendezvousConditions {
  double corner_sigma_m = 0;  ///< m, of a corner in each axis, at any range; 0: as a laser has it
  int looks_at_start = 20;    ///< while the robot stands: four seconds of a laser's
  bool exact = false;         ///< nothing errs, though all say that they may
};

/// The experiment of Zhou and Roumeliotis (2006), section IV, in simulation: a building of 80 m by 60 m
/// (4,800 m²), a corridor all round it with 124 corners. The robots start 85 m apart. Robot 1 goes three
/// quarters of the way round and comes back, robot 2 comes round the other side; they meet 10 m from where
/// robot 1 began, at one end of both maps (figures 7 to 9 there), having seen about 95 and 60 corners, about
/// 31 of them both. What the paper does not tell: corners err as scanmatch/features finds them, and a robot
/// stands for some seconds before it goes, as the whole map hangs on what it sees there.
///
///        0 -------------------- 60 ------ 80
///       60 +---<--------- R2 <---+-------+       R1 from (0, 0) eastwards to (12, 60), and back;
///          |                             |       R2 from (60, 60) westwards, and down
///       R2 v                             ^ R1
///          | they meet here              |
///        0 +--- R1 ---------------->-----+
struct RendezvousExperiment {
  FeatureState one, two;
  std::vector<int> corner_of_one, corner_of_two;  ///< by feature id
  Pose truth_of_two;                              ///< of robot 2 in the frame of robot 1's start
  RobotAlignment alignment;                       ///< of one mutual sighting, σ 0.02 m and 0.07 rad
};
RendezvousExperiment run_rendezvous_experiment(std::uint64_t seed, const RendezvousConditions& options = {});

/// The largest 3σ of a corner that any consistent estimator can reach in it, all true twins being known: the
/// batch fit's, linear about the truth (Cramér and Rao's bound). It comes from the filter without noise,
/// whose covariance there is that of the batch fit, and twins measured one by one in one joint covariance.
double least_3_sigma_m(std::uint64_t seed, RendezvousConditions options = {});

/// What the fusion made of it.
struct RendezvousScore {
  std::size_t corners_1 = 0;
  std::size_t corners_2 = 0;
  std::size_t duplicates = 0;   ///< true ones
  std::size_t found = 0;        ///< of them
  std::size_t wrong = 0;        ///< pairs that are none
  double before_3_sigma_m = 0;  ///< largest of all corners: three times the longer half axis, aligned only
  double after_3_sigma_m = 0;   ///< and fused
  double least_3_sigma_m = 0;   ///< that can be reached, if it was computed
  double nees_before = 0;       ///< NEES/3 of robot 2's pose
  double nees_after = 0;
  double fusion_cpu_ms = 0;
};
RendezvousScore judge_fusion(const RendezvousExperiment& experiment);

/// Sums of counts, means of the rest but the largest 3σ, which are means too.
RendezvousScore mean_of(const std::vector<RendezvousScore>& scores);

}  // namespace isthmus
