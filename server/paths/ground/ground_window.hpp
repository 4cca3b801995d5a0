#pragma once

#include <array>
#include <utility>
#include <vector>

#include "server/paths/ground/ground_tile.hpp"

namespace isthmus {

/// A tile and the eight around it, row by row; null where there is none. The tile itself is the fifth.
struct TilesAround {
  std::array<const GroundTile*, 9> tiles{};

  const GroundTile& middle() const { return *tiles[4]; }
};

/// The eight cells around one.
template <class Visit>
void visit_beside(const Cell& cell, const Visit& visit) {
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx)
      if (dx != 0 || dy != 0) visit(Cell{cell.x + dx, cell.y + dy});
}

/// The cells of a tile and of a margin around it, as a surface by themselves: what can be told of the tile's
/// cells without the rest of the ground is told from this, quickly. Outside it nothing is known.
class GroundWindow {
 public:
  /// The margin in cells, at most a tile's side.
  GroundWindow(const TilesAround& tiles, int margin_cells, const NearPatches& near);

  std::size_t size() const { return cells_.size(); }
  const Cell& cell(NodeId node) const { return cells_[index(node)]; }
  PatchId leader(NodeId node) const { return leaders_[leader_[index(node)]]; }
  bool occupied(NodeId node) const { return occupied_[index(node)] != 0; }

  /// The nodes of a cell, from `first` to before `second`.
  std::pair<NodeId, NodeId> at(const Cell& cell) const {
    const auto x = cell.x - low_.x, y = cell.y - low_.y;
    if (x < 0 || x >= side_ || y < 0 || y >= side_) return {0, 0};
    const auto i =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(x);
    return {first_[i], first_[i + 1]};
  }
  /// The node of a cell of one layer; -1 where there is none, or several.
  NodeId only(const Cell& cell) const {
    const auto [first, last] = at(cell);
    return last - first == 1 ? first : -1;
  }
  /// The node of a cell that one's own layer goes on in, as `Ground::step`.
  NodeId step(NodeId from, const Cell& to) const {
    const auto [first, last] = at(to);
    const bool goes_on = last - first == 1 && leader_[index(first)] == leader_[index(from)];
    return goes_on ? first : nearest(leader_[index(from)], first, last);
  }

  /// Visits the nodes of the tile in the middle in the order of its layers.
  template <class Visit>
  void visit_middle(const Visit& visit) const {
    for (int y = margin_; y < side_ - margin_; ++y) {
      const auto row = static_cast<std::size_t>(y) * static_cast<std::size_t>(side_);
      const auto begin = row + static_cast<std::size_t>(margin_),
                 end = row + static_cast<std::size_t>(side_ - margin_);
      for (NodeId node = first_[begin]; node < first_[end]; ++node) visit(node);
    }
  }

 private:
  static std::size_t index(NodeId node) { return static_cast<std::size_t>(node); }
  void add(const GroundTile& tile, int row, int column_begin, int column_end);
  std::uint16_t number_of(PatchId leader);
  NodeId nearest(std::uint16_t leader, NodeId first, NodeId last) const;

  Cell low_;
  int side_ = 0;
  int margin_ = 0;
  std::vector<NodeId> first_;  // by cell, row by row; one more than there are cells
  std::vector<Cell> cells_;
  std::vector<std::uint16_t> leader_;   // by node: a place among the leaders
  std::vector<std::uint8_t> occupied_;  // by node
  std::vector<PatchId> leaders_;
  std::vector<float> ways_m_;  // between leaders, row by row
};

}  // namespace isthmus
