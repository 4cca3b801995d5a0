#pragma once

#include <span>
#include <vector>

#include "server/output/vector_plan/plan_options.hpp"
#include "server/output/vector_plan/plan_source.hpp"
#include "server/output/vector_plan/wall_line.hpp"

namespace isthmus {

/// How many views looked through each bin of each line: element [line][bin], bins of `bin_m` from the line's
/// `from` end on. A beam goes through where it crosses the line and ends well behind it. Cost: beams times
/// the lines near each.
std::vector<std::vector<int>> count_passes(std::span<const WallLine> lines, std::span<const View> views,
                                           const StretchOptions& options);

/// The number of bins of a line.
std::size_t bin_count(const WallLine& line, const StretchOptions& options);

}  // namespace isthmus
