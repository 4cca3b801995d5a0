#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "server/paths/roads/roadmap.hpp"

namespace isthmus {

/// A short way over a roadmap's squares from cell to cell, both of which must fit: lazy Theta* (Nash, Koenig
/// and Tovey 2010), which looks at lines of sight between the middles of squares. Each cell of the answer is
/// seen from the one before. Nothing where there is no way, or none was found in so many steps.
std::optional<std::vector<NodeId>> find_route(const Roadmap& roadmap, NodeId from, NodeId to,
                                              std::size_t max_steps);

/// What a way costs to every square, and to none that cannot be reached: Dijkstra's search from a cell that
/// fits, over the middles of squares, in metres (infinity). It is up to a tenth longer than the shortest way.
std::vector<float> costs_from(const Roadmap& roadmap, NodeId from);

}  // namespace isthmus
