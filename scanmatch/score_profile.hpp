#pragma once

#include <span>

#include "scanmatch/match.hpp"

namespace isthmus {

struct WeakDirectionOptions {
  double step_m = 0.07;
  double sharpness = 120;
  double held_information = 1e7;
  double start_kernels = 2;
  int max_points = 90;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(step_m, "step_m", "m", "between the places at which the scan is held along the weakest direction");
    option(sharpness, "sharpness", "factor",
           "how surely a worse fit is a wrong one: beams err together, so their number counts for little");
    option(held_information, "held_information", "1/m²", "that holds the scan there");
    option(start_kernels, "start_kernels", "factor",
           "scale of the robust loss at the beginning, of that at the end");
    option(max_points, "max_points", "count", "of the scan that are used");
  }
};

/// How far a match may be off along the direction of the plane that its beams determine least, in metres
/// (standard deviation): from how well the scan fits when it is held at places along that direction, up to
/// `half_width_m` either way, and turned and shifted across it to fit best there.
///
/// A match's own information is that of its minimum. Along a corridor the next door frame makes another
/// minimum a step away which fits hardly worse, and a loop closed there bends the map by that step.
double sigma_along_weak_direction(const LocalMap& local_map, std::span<const ScanPoint> points,
                                  const Match& match, double half_width_m, const MatchOptions& options,
                                  const WeakDirectionOptions& weak_direction_options);

/// The same match, trusted along that direction only as far as that uncertainty leaves it: its relations will
/// say so. `sigma_m`: the noise of one correspondence.
void widen(Match& match, double weak_sigma_m, double sigma_m, const MatchOptions& options);

/// The same where it is known already that the scan belongs nowhere else, as of a piece of way that was found
/// as a whole: then also further than before. Few beams that tell of a direction are trusted little, as they
/// may be wrong together, but that the scan fits worse wherever else it is held is more than they say. No
/// further than all its beams, nor than the profile's steps tell apart.
void believe_profile(Match& match, double weak_sigma_m, double sigma_m, const MatchOptions& options,
                     const WeakDirectionOptions& weak_direction_options);

}  // namespace isthmus
