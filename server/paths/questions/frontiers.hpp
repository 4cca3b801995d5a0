#pragma once

#include <vector>

#include "server/paths/roads/roadmap.hpp"

namespace isthmus {

/// Free ground that borders on what nobody has seen (Yamauchi 1997), of one layer.
struct Frontier {
  NodeId node = -1;                                  ///< the cell of it that is nearest to its middle
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();  ///< in the island's frame, metres
  double size_m = 0;                                 ///< the diagonal of its cells' bounding box
  double gain_m2 = 0;     ///< the unseen that a laser at the viewpoint would see if nothing stood in it
  NodeId viewpoint = -1;  ///< where the footprint fits, near it; -1: nowhere
  double cost_m = 0;      ///< of the way to the viewpoint; infinity where there is none
};

struct FrontierOptions {
  /// Of a frontier, in the footprint's diameters: through a smaller one no robot passes, and it is a gap
  /// between beams.
  double min_size_diameters = 1;
  double max_size_m = 4;   ///< a longer one is cut in two, until none is
  double min_gain_m2 = 1;  ///< behind which there is less is none either
  double view_m = 4;       ///< how far the gain looks
  double reach_m = 1.5;    ///< of the viewpoint from the frontier, along the surface
  /// The viewpoint is the nearest to the frontier of those that can be reached, wherever the robot is; else
  /// the one that the way to is shortest.
  bool close_up = false;
};

/// The frontiers of a ground by falling gain. `from`: where the robot is, a cell that fits; -1: nobody asks
/// for costs, which are all 0 then. Costs are up to a tenth too high.
std::vector<Frontier> find_frontiers(const Roadmap& roadmap, NodeId from,
                                     const FrontierOptions& options = {});

}  // namespace isthmus
