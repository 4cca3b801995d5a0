#pragma once

#include <optional>
#include <span>
#include <vector>

#include "server/features/association/association.hpp"
#include "server/features/fusion/rendezvous.hpp"

namespace isthmus {

struct FusionOptions {
  AssociationOptions association;  ///< overlap, tolerances and the bound of the search
  double probability = 0.999;      ///< that a true pair passes: a twin that is missed stays double for good
  std::size_t at_once = 8;  ///< features paired together: what lies as near to the rendezvous as the next
  double identity_sigma_m =
      1e-3;                 ///< m, rad: two maps of one thing agree to a millimetre; keeps matrices definite
  bool points = true;       ///< whether points may be twins; not those that are known by a name
  double min_log_odds = 3;  ///< by which a pair is the likeliest account of its group: 20 to 1
  std::size_t steps_per_feature = 2'000;  ///< of the second map, that the searches may take together
                                          ///< (SearchWork): 20 times what the fullest maps tried needed;
                                          ///< then no more twins are looked for
  double linear_rad = 5e-3;  ///< rad that the second map may turn before all is taken about its new place:
                             ///< 100 m away it is off by a millimetre then
};

/// What a fusion found.
struct Fusion {
  struct Duplicate {
    int kept = 0;  ///< ids in the joint state
    int gone = 0;
  };
  FeatureState state;                 ///< duplicates removed
  Pose one_from_two;                  ///< where the second map's frame came to lie
  std::vector<Duplicate> duplicates;  ///< in the order in which they were found
  double squared_distance = 0;        ///< of sighting and pairings together, over `degrees_of_freedom`
  int degrees_of_freedom = 0;
  bool came_to_end = true;  ///< whether all was looked at before the searches' steps were used up
};

/// Two maps become one at a rendezvous: aligned; duplicates found from the rendezvous outwards, for what the
/// alignment errs grows with the distance from it (Zhou and Roumeliotis 2006, III-E and algorithm 1). A few
/// at a time: what may be each one's twin comes from a kd-tree, within what both may be off; the likeliest
/// account of the group decides (server/features/fusion/twin_search.hpp), and what it leaves open waits for
/// the others. Each pair is measured to be one (eq. 20), which tells where the second map lies; where that
/// turns it, all is taken anew about its new place, so that nothing is compared by an alignment that is
/// degrees off. Until then both maps stay as they are (server/features/fusion/tie_filter.hpp): the joint
/// covariance is made once, of what is kept. A pair that all others contradict goes.
///
/// Afterwards there is one state for all robots: further meetings are measurements in it
/// (FeatureFilter::observe_robot), and nothing is counted twice. The inputs are unchanged: a fusion that
/// turns out wrong is dropped by going on with them. Robots that met once, where the maps had nothing in
/// common yet, are told by their marks (add_mark).
Fusion fuse(const FeatureState& one, PoseOwner robot_1, const FeatureState& two, PoseOwner robot_2,
            const RobotAlignment& alignment, const FusionOptions& options = {});
inline Fusion fuse(const FeatureState& one, int robot_1, const FeatureState& two, int robot_2,
                   const RobotAlignment& alignment, const FusionOptions& options = {}) {
  return fuse(one, PoseOwner{robot_1}, two, PoseOwner{robot_2}, alignment, options);
}

/// That a feature of the first map is one of the second, by indices.
struct TwinSeed {
  std::size_t one = 0;
  std::size_t two = 0;
};

/// The same without a rendezvous: some features that are one are known, and tell where the second map lies,
/// about one_from_two; others are looked for from them outwards. What they tell must determine a pose: walls
/// of two directions, two of each at least, for what all others contradict goes. Nothing where it does not.
std::optional<Fusion> fuse(const FeatureState& one, const FeatureState& two, const Pose& one_from_two,
                           std::span<const TwinSeed> seeds, const FusionOptions& options = {});

}  // namespace isthmus
