#pragma once

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "server/paths/ground/ground.hpp"
#include "server/paths/ground/zones.hpp"
#include "server/paths/roads/point_graph.hpp"
#include "server/paths/roads/regions.hpp"

namespace isthmus {

/// What a robot needs around its centre, in metres.
struct Footprint {
  double radius_m = 0.25;
  double clearance_m = 0.1;  ///< more than that from walls
};

/// A square of a layer: its number in a roadmap; -1: none.
using SquareId = std::int32_t;

/// Where on a ground a footprint fits: its cells, joined to squares of 20 cm a side at most, and which
/// squares one steps between. Never changed.
class Roadmap {
 public:
  /// It fits nowhere nearer to keep-out zones than its radius.
  Roadmap(std::shared_ptr<const Ground> ground, const Footprint& footprint, std::span<const Zone> zones = {});

  const Ground& ground() const { return *ground_; }
  const Footprint& footprint() const { return footprint_; }

  bool fits(NodeId node) const { return square(node) >= 0; }
  SquareId square(NodeId node) const { return square_[static_cast<std::size_t>(node)]; }
  std::size_t squares() const { return middle_.size(); }
  /// One of a square's cells, which stands for it.
  NodeId middle(SquareId square) const { return middle_[static_cast<std::size_t>(square)]; }
  std::span<const SquareId> beside(SquareId square) const { return graph_.beside(square); }
  /// The squares, at the centres of their middles.
  const PointGraph& graph() const { return graph_; }
  const Regions& regions() const { return regions_; }

  /// So many cells in rows and columns around this one the footprint fits, the ground has one layer only, and
  /// stepping comes to it: within them a line of sight need not be looked at.
  std::int32_t open_cells(NodeId node) const { return open_[static_cast<std::size_t>(node)]; }

  /// The cell that one comes to straight from another where the footprint fits all along.
  std::optional<NodeId> straight(NodeId from, const Cell& to) const;
  bool sees(NodeId from, NodeId to) const { return straight(from, ground_->cell(to)) == to; }

 private:
  void find_squares(const Footprint& footprint, const KeptOutCells& kept_out);
  void flood(NodeId start);
  void find_beside();
  void find_open();
  bool is_open(NodeId node) const;

  std::shared_ptr<const Ground> ground_;
  Footprint footprint_;
  std::vector<SquareId> square_;    // by node
  std::vector<NodeId> middle_;      // by square
  std::vector<std::uint8_t> open_;  // by node
  PointGraph graph_;
  Regions regions_;
};

}  // namespace isthmus
