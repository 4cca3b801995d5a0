#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "tools/evaluate/relation_error.hpp"
#include "tools/evaluate/trajectories.hpp"

namespace isthmus {

/// The same moment in the truth and in the estimate.
struct PosePair {
  Pose truth_from_robot;
  Pose map_from_robot;
};

/// truth_from_map: the rigid motion of least squared distance between positions (Umeyama, PAMI 13, 1991, in
/// the plane and without scale).
Pose align(std::span<const PosePair> pairs);

/// Absolute error of one robot on one island, after the island as a whole has been moved onto the truth.
struct AbsoluteErrors {
  std::string robot;
  int island = 0;
  std::size_t count = 0;
  double rms_m = 0;
  Statistics translation_m;
  Statistics rotation_deg;
};

/// Compares the estimate with the truth at each of the truth's stamps that has a pose within 0.1 s: all
/// robots of an island are aligned together, by one motion. In order of island, then robot.
std::vector<AbsoluteErrors> evaluate_absolute(const std::map<std::string, Trajectory>& truth,
                                              const TeamTrajectories& team);

}  // namespace isthmus
