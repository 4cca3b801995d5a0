#pragma once

#include <functional>
#include <vector>

#include "server/paths/roads/roadmap.hpp"

namespace isthmus {

/// What a search for a way keeps to: `is_barred` says whether a robot that has come so many metres may not be
/// at a point of the island's plane, `is_wanted` whether it may end there.
struct WayWanted {
  std::function<bool(const Eigen::Vector2d& point, double along_m)> is_barred;
  std::function<bool(SquareId square, const Eigen::Vector2d& point)> is_wanted;
  double max_m = 0;  ///< longer ways are not looked at
};

/// The shortest way over a roadmap's squares from a cell that fits to a square that is wanted (Dijkstra
/// 1959), without what need not be turned at; each cell is seen from the one before. Where it is barred at
/// its start it may leave. Empty: none. `opened`: grows by the squares that were looked at.
std::vector<NodeId> find_clear_way(const Roadmap& roadmap, NodeId from, const WayWanted& wanted,
                                   std::size_t& opened);

}  // namespace isthmus
