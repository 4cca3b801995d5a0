#pragma once

#include <cstdint>
#include <vector>

#include "server/features/fusion.hpp"

namespace isthmus {

/// The experiment of Zhou and Roumeliotis (2006), section IV, in simulation: a building of 80 m by 60 m
/// (4,800 m²), a corridor all round it with 124 corners. Robot 1 goes three quarters of the way round and a
/// stretch back, robot 2 comes from the other side; they meet where robot 1 turned back, off to one side of
/// its map, having seen about 95 and 60 corners, about 31 of them both.
///
///        0 ------------------------------ 80
///       60 +---<--------- R1 <-----------+       R1 from (0, 0) eastwards, R2 from (0, 0) northwards
///          |  they meet up here          ^
///          ^ R2                          | R1
///          |                             |
///        0 +--- R1 --->------------------+
struct RendezvousExperiment {
  FeatureState one, two;
  std::vector<int> corner_of_one, corner_of_two;  ///< by feature id
  Pose truth_of_two;                              ///< of robot 2 in the frame of robot 1's start
  RobotAlignment alignment;                       ///< of one mutual sighting, σ 0.02 m and 0.07 rad
};
RendezvousExperiment run_rendezvous_experiment(std::uint64_t seed);

/// What the fusion made of it.
struct RendezvousScore {
  std::size_t corners_1 = 0;
  std::size_t corners_2 = 0;
  std::size_t duplicates = 0;   ///< true ones
  std::size_t found = 0;        ///< of them
  std::size_t wrong = 0;        ///< pairs that are none
  double before_3_sigma_m = 0;  ///< largest of all corners: three times the longer half axis, aligned only
  double after_3_sigma_m = 0;   ///< and fused
  double nees_before = 0;       ///< NEES/3 of robot 2's pose
  double nees_after = 0;
  double fusion_cpu_ms = 0;
};
RendezvousScore judge_fusion(const RendezvousExperiment& experiment);

/// Sums of counts, means of the rest but the largest 3σ, which are means too.
RendezvousScore mean_of(const std::vector<RendezvousScore>& scores);

}  // namespace isthmus
