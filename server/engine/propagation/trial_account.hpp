#pragma once

#include <tuple>
#include <vector>

#include "patches/ids.hpp"

namespace isthmus {

/// What spoke for and against a closure on its trial, as far as it was looked at; what it was held against is
/// in TrialOptions.
struct TrialAccount {
  int supporters = 0;        ///< sightings, or finds of scans, that propose it
  bool two_way = false;      ///< of sightings: each of the two has seen the other
  int compared = 0;          ///< patches along the border that were matched with the other side, and
  int matched = 0;           ///< those of them that did match
  double cost = 0;           ///< mean χ² after the fit: of sightings per residual, of finds per relation
  double contradiction = 0;  ///< share of hits of one side deep in the other's free space, and
  double own_contradiction = 0;     ///< of either side in its own
  double way_m = 0;                 ///< of what matches
  double unmatched_m = 0;           ///< of way that both sides know and on which nothing matches
  double width_m = 0;               ///< of what matches, across its length
  double own_m = 0;                 ///< way that either of two maps has beyond the other: the lesser
  double border_contradiction = 0;  ///< of two maps, near what matches
  int look_alikes = 1;              ///< places that look alike, of which this is one
  double prior_log_odds = 0;        ///< that it is true: by what proposes it,
  double sighting_log_odds = 0;     ///< by how many sightings agree,
  double revisit_log_odds = 0;      ///< rather than a look-alike: by where the map had its ends,
  double shared_log_odds = 0;       ///< by how much matches, of a loop less by ground where nothing does,
  double fit_log_odds = 0;          ///< and by how badly finds and scans fit: none speaks for it
  int layers_before = 0;            ///< pairs of patches that contradict one another without it,
  int layers_after = 0;             ///< and with it, where nothing else decided;
  double layers_log_odds = 0;       ///< by their difference

  std::vector<ClosureId>
      rests_on;                ///< loops closed before by which the map had its ends where they were found
  int blamed = 0;              ///< relations of the map that are wrong if it is true,
  ClosureId blamed_closure;    ///< the closure that they rest on, if that is what was wrong,
  double blamed_log_odds = 0;  ///< and that nothing of the kind is wrong, but for it

  /// That these are true, as the map that they made was right where the ends were found.
  double confirmed_log_odds() const { return blamed > 0 || revisit_log_odds < 0 ? 0 : revisit_log_odds; }
  /// By all of them.
  double log_odds() const {
    return prior_log_odds + sighting_log_odds + revisit_log_odds + shared_log_odds + fit_log_odds +
           layers_log_odds - blamed_log_odds;
  }

  auto members() {
    return std::tie(supporters, two_way, compared, matched, cost, contradiction, own_contradiction, way_m,
                    unmatched_m, width_m, own_m, border_contradiction, look_alikes, prior_log_odds,
                    sighting_log_odds, revisit_log_odds, shared_log_odds, fit_log_odds, layers_before,
                    layers_after, layers_log_odds, rests_on, blamed, blamed_closure, blamed_log_odds);
  }
};

}  // namespace isthmus
