#pragma once

#include <functional>
#include <span>
#include <vector>

#include "server/paths/ground/ground_window.hpp"

namespace isthmus {

/// A node from which one is this near to a cell that distances are measured to.
struct Source {
  NodeId node = -1;
  Cell cell;
};

/// For each node how far its centre is from the nearest source's cell, in metres, along the surface: from a
/// point of that cell that lies nearest, at least. No more than `reach_m`. A brushfire that carries the
/// nearest source along (Kalra, Ferguson and Stentz 2009). A node to which a source's cell is nothing
/// (`counts`; empty: it always is something) does not carry it on.
std::vector<float> distances_m(const GroundWindow& ground, std::span<const Source> sources, double reach_m,
                               const std::function<bool(NodeId node, const Cell& source)>& counts = {});

}  // namespace isthmus
