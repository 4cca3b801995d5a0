#pragma once

#include <span>

#include "scanmatch/match.hpp"

namespace isthmus {

/// How far a match may be off along the direction of the plane that its beams determine least, in metres
/// (standard deviation): from how well the scan fits when it is held at places along that direction, up to
/// `half_width_m` either way, and turned and shifted across it to fit best there.
///
/// A match's own information is that of its minimum. Along a corridor the next door frame makes another
/// minimum a step away which fits hardly worse, and a loop closed there bends the map by that step.
double spread_of_match(const LocalMap& local_map, std::span<const ScanPoint> points, const Match& match,
                       double half_width_m, const MatchOptions& options = {});

/// The same match, trusted along that direction only as far as a spread leaves it: its relations will say so.
/// `sigma_m`: the noise of one correspondence.
void widen(Match& match, double spread_m, double sigma_m, const MatchOptions& options = {});

}  // namespace isthmus
