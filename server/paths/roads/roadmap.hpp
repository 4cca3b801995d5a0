#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "server/paths/ground/ground.hpp"
#include "server/paths/ground/zones.hpp"
#include "server/paths/roads/point_graph.hpp"
#include "server/paths/roads/regions.hpp"
#include "server/paths/roads/road_tile.hpp"

namespace isthmus {

/// Where on a ground a footprint fits: the squares of its tiles, and which of them one steps between. Never
/// changed.
class Roadmap {
 public:
  /// It fits nowhere nearer to keep-out zones than its radius. `before`: a roadmap for the same footprint and
  /// zones, of which tiles are kept whose surface is the same.
  Roadmap(std::shared_ptr<const Ground> ground, const Footprint& footprint, std::span<const Zone> zones = {},
          const Roadmap* before = nullptr);

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
  /// stepping comes to it: within them a line of sight need not be looked at. At least; no cell beyond the
  /// tile counts.
  std::int32_t open_cells(NodeId node) const { return open_[static_cast<std::size_t>(node)]; }

  /// The cell that one comes to straight from another where the footprint fits all along.
  std::optional<NodeId> straight(NodeId from, const Cell& to) const;
  bool sees(NodeId from, NodeId to) const { return straight(from, ground_->cell(to)) == to; }

 private:
  using Pairs = std::vector<std::pair<SquareId, SquareId>>;

  void make_tiles(std::span<const Zone> zones, const Roadmap* before);
  Pairs join_tiles();
  void join_across(std::size_t tile, Pairs& pairs) const;

  std::shared_ptr<const Ground> ground_;
  Footprint footprint_;
  std::vector<std::shared_ptr<const RoadTile>> tiles_;  // as the ground's
  std::vector<SquareId> square_;                        // by node
  std::vector<NodeId> middle_;                          // by square
  std::vector<std::uint8_t> open_;                      // by node
  PointGraph graph_;
  Regions regions_;
};

}  // namespace isthmus
