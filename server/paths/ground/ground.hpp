#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "server/paths/ground/tile_surface.hpp"

namespace isthmus {

/// The cells of an island in layers, as a surface: one steps from a cell to the eight beside it, within
/// patches that are near one another (Howard et al. 2006, eqs. 2 and 3, along relations). Never changed.
class Ground {
 public:
  /// Distances are known up to this.
  static constexpr double reach_m = measured_reach_m;

  /// Surfaces of one island, by their rows and columns.
  Ground(std::vector<std::shared_ptr<const TileSurface>> surfaces, std::shared_ptr<const NearPatches> near);

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
  /// Whether nobody has seen one of the four cells that have a side in common with this one.
  bool borders_on_unseen(NodeId node) const { return borders_on_unseen_[index(node)] != 0; }

  /// What the ground is made of, tile by tile; a tile's nodes are numbered on from `first_node`.
  const std::vector<std::shared_ptr<const TileSurface>>& surfaces() const { return surfaces_; }
  NodeId first_node(std::size_t surface) const { return first_node_[surface]; }
  const std::shared_ptr<const NearPatches>& near() const { return near_; }

 private:
  static std::size_t index(NodeId node) { return static_cast<std::size_t>(node); }
  void find_tiles();
  void add(const TileSurface& surface);
  /// Of the tile of a cell; -1: there is none.
  std::int32_t tile_index(const Cell& cell) const;

  std::vector<std::shared_ptr<const TileSurface>> surfaces_;
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
  std::vector<std::uint8_t> borders_on_unseen_;
};

}  // namespace isthmus
