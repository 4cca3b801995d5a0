#pragma once

#include <optional>
#include <span>

#include "server/feature_maps/meeting/clue.hpp"

namespace isthmus {

/// The placing that explains the clues best, with how probable it is that this one is right. Clues may be
/// one-way, and ranges or bearings alone: it takes as many as determine a pose.
///
/// The model: each encounter is what it says with a probability, else its sightings are anywhere within
/// reach. The odds are the mass of the posterior near the answer (Laplace's approximation, before it uniform
/// within reach and over all headings) against all other masses: other answers; that none is true; and, for
/// each encounter, that it is false, and the map anywhere that the others allow. So a placing that hangs on
/// one encounter has the odds of that one being true, however many sightings agree in the rest.
///
/// Nothing where the clues do not determine a pose. Deterministic.
std::optional<MapPlacement> best_placement(std::span<const Clue> clues, const PlacementOptions& options);

/// The log of how much likelier a clue is where the second map lies there than if it were false.
double clue_log_ratio(const Clue& clue, const Pose& one_from_two, const PlacementOptions& options);

}  // namespace isthmus
