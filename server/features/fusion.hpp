#pragma once

#include "server/features/association.hpp"
#include "server/features/rendezvous.hpp"

namespace isthmus {

struct FusionOptions {
  AssociationOptions association;  ///< overlap, tolerances and the bound of the search
  double probability = 0.999;      ///< that a true pair passes: a twin that is missed stays double for good
  std::size_t at_once = 8;  ///< features paired together: what lies as near to the rendezvous as the next
  double identity_sigma_m =
      1e-3;              ///< m, rad: two maps of one thing agree to a millimetre; keeps matrices definite
  double ambiguity = 6;  ///< by which the second best must be worse in squared distance: e³ times less likely
  bool points = true;    ///< whether points may be twins; not those that are known by a name
  double max_by_chance =
      0.1;  ///< landmarks expected within a pair's gate, of one pair at least of each group
};

/// What a fusion found.
struct Fusion {
  struct Duplicate {
    int kept = 0;  ///< ids in the joint state
    int gone = 0;
  };
  FeatureState state;                 ///< duplicates removed
  std::vector<Duplicate> duplicates;  ///< in the order in which they were found
  double squared_distance = 0;        ///< of all pairings together, over `degrees_of_freedom`
  int degrees_of_freedom = 0;
};

/// Two maps become one at a rendezvous: aligned; duplicates found from the rendezvous outwards, for what the
/// alignment errs grows with the distance from it (Zhou and Roumeliotis 2006, III-E and algorithm 1). A few
/// at a time: what may be each one's twin comes from a kd-tree, within what both may be off; joint
/// compatibility decides; each pair is measured to be one (eq. 20), the nearest first, which corrects the
/// whole second map. Where another twin is nearly as likely it waits for the others, and stays a feature of
/// its own if that does not settle it. A first pairing that is wrong leads the others astray, and then few
/// are found: so all is tried with groups of twice and four times the size too, and the search that finds the
/// most twins holds. Then the same once more, linear about where the maps were found to lie.
///
/// Afterwards there is one state for all robots: further meetings are measurements in it
/// (FeatureFilter::observe_robot), and nothing is counted twice. The inputs are unchanged: a fusion that
/// turns out wrong is dropped by going on with them.
Fusion fuse(const FeatureState& one, int robot_1, const FeatureState& two, int robot_2,
            const RobotAlignment& alignment, const FusionOptions& options = {});

}  // namespace isthmus
