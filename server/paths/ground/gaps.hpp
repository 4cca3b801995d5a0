#pragma once

#include <vector>

#include "server/paths/ground/ground_window.hpp"

namespace isthmus {

/// A cell that nobody has seen, and the patch that leads what lies around it.
struct GapCell {
  Cell cell;
  PatchId leader;
};

/// Gaps smaller than this, in metres along the diagonal of their bounding box, are no unknown ground.
inline constexpr double max_gap_m = 0.5;

/// The cells of gaps: unseen ones with free ground of one layer all around. They are what teammates hid, or
/// lay between beams: something that stands there would have been hit at the gap's rim by some beam. Nobody
/// is sent to look at what is narrower than a robot, so that it would bar a door for ever. In order.
std::vector<GapCell> find_gaps(const GroundWindow& ground);

}  // namespace isthmus
