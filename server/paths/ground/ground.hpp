#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "server/paths/ground/ground_tile.hpp"

namespace isthmus {

/// A cell of a layer: its number on its island's ground; -1: none.
using NodeId = std::int32_t;

/// The cells of an island in layers, as a surface: one steps from a cell to the eight beside it, within
/// patches that are near one another (Howard et al. 2006, eqs. 2 and 3, along relations). Never changed.
class Ground {
 public:
  /// Distances are known up to this.
  static constexpr double reach_m = 1.2;

  /// Tiles of one island, by their rows and columns.
  Ground(std::vector<std::shared_ptr<const GroundTile>> tiles, std::shared_ptr<const NearPatches> near);

  std::size_t size() const { return cells_.size(); }
  const Cell& cell(NodeId node) const { return cells_[index(node)]; }
  const Layer& layer(NodeId node) const { return layers_[index(node)]; }
  Eigen::Vector2d centre(NodeId node) const { return centre_of(cell(node)); }

  /// The nodes of a cell, from `first` to before `second`.
  std::pair<NodeId, NodeId> at(const Cell& cell) const;
  /// The node of a cell of one layer; -1 where there is none, or several.
  NodeId only(const Cell& cell) const {
    const auto [first, last] = at(cell);
    return last - first == 1 ? first : -1;
  }
  /// The node of a cell beside one's own on the surface; -1 where nothing is known to go on there.
  NodeId step(NodeId from, const Cell& to) const;
  /// The layer of a cell that a patch is of: its own where it leads one, else that which is nearest to it
  /// along relations; -1 where there is none.
  NodeId find(const Cell& cell, PatchId patch) const;

  /// From the cell's centre to the nearest occupied cell, in metres, at least; no more than `reach_m`.
  float wall_m(NodeId node) const { return wall_m_[index(node)]; }
  /// The same to the nearest cell that nobody has seen.
  float unseen_m(NodeId node) const { return unseen_m_[index(node)]; }

 private:
  static std::size_t index(NodeId node) { return static_cast<std::size_t>(node); }
  void lay_out();
  void fill_gaps();
  void measure();
  /// Of the tile of a cell; -1: there is none.
  std::int32_t tile_index(const Cell& cell) const;

  std::vector<std::shared_ptr<const GroundTile>> tiles_;
  std::shared_ptr<const NearPatches> near_;
  Cell low_tile_;  // in tiles
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::int32_t> tile_at_;  // by row and column; -1: none
  std::vector<NodeId> first_node_;     // by tile
  std::vector<Cell> cells_;
  std::vector<Layer> layers_;
  std::vector<float> wall_m_;
  std::vector<float> unseen_m_;
};

/// The eight cells around one.
template <class Visit>
void visit_beside(const Cell& cell, const Visit& visit) {
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx)
      if (dx != 0 || dy != 0) visit(Cell{cell.x + dx, cell.y + dy});
}

}  // namespace isthmus
