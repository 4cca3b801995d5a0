#pragma once

#include <span>
#include <vector>

#include "server/output/vector_plan/plan_options.hpp"
#include "server/output/vector_plan/plan_source.hpp"
#include "server/output/vector_plan/wall_fit.hpp"

namespace isthmus {

/// A part of a line, in metres along it from its middle.
struct Stretch {
  double from_m = 0;
  double to_m = 0;
  int views = 0;             ///< that saw some of it; 0 for an opening
  double room_before_m = 0;  ///< that it may reach on before `from_m`: nobody looked through there
  double room_after_m = 0;   ///< and after `to_m`
};

struct Stretches {
  std::vector<Stretch> walls;     ///< in order along the line
  std::vector<Stretch> openings;  ///< of a door's width, between two of them
};

/// What of a line is wall: where at least `min_views` saw it, or one in a long piece, and no fewer than
/// looked through. Short gaps
/// that nobody looked through were hidden and are closed. An opening is a gap of a door's width that beams
/// went through in most of its length; where there are no views (`passes` empty), one between two ends that
/// are known.
Stretches stretches_of(const FittedWall& wall, std::span<const FeatureSeen> segments,
                       std::span<const int> passes, const StretchOptions& options);

}  // namespace isthmus
