#pragma once

#include <optional>

#include "server/feature_maps/merging/placing_account.hpp"

namespace isthmus {

/// The placing of one map in another that their walls speak for most, with how probable it is.
struct PlacingJudgement {
  PlacingAccount best;
  double log_odds = 0;  ///< that it is right, rather than any other placing or none
};

/// What walls alone say of where the second map lies in the first. For a placing speaks what it explains,
/// against it what would stand where the other map saw through, and every other placing that explains about
/// as much: as far as the best one explains walls where the other has seen nothing, these do not tell them
/// apart if the building repeats itself, as it seems to where the other one explains a good share too. Two
/// maps that share a room or a wing may be of two that look alike: both must go on beyond what they share.
/// Nothing where that is not so, where what is shared is one corridor, or where less speaks for any placing
/// than against it. Deterministic; bounded by the options.
std::optional<PlacingJudgement> judge_placings(const MapSketch& one, const MapSketch& two,
                                               const MergingOptions& options);

/// The pairs that a fusion may begin with: where most twins are, those that lie closest, of both directions;
/// none where there are too few.
std::vector<WallTwin> surest_twins(const MapSketch& one, const PlacingAccount& account,
                                   const MergingOptions& options);

}  // namespace isthmus
