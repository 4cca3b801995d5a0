#include "server/paths/ground/ground_window.hpp"

#include <algorithm>
#include <limits>

namespace isthmus {

GroundWindow::GroundWindow(const TilesAround& tiles, int margin_cells, const NearPatches& near)
    : side_(ground_tile_cells + 2 * margin_cells), margin_(margin_cells) {
  const Cell& middle = tiles.middle().low;
  low_ = {middle.x - margin_cells, middle.y - margin_cells};
  first_.reserve(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_) + 1);
  first_.push_back(0);
  for (int y = 0; y < side_; ++y) {
    // Cells of the tiles to the left, in the middle and to the right.
    const int row = low_.y + y - middle.y;
    const std::size_t tile_row = row < 0 ? 0 : row < ground_tile_cells ? 3 : 6;
    for (int column = 0; column < 3; ++column) {
      const int begin = std::max(low_.x, middle.x + (column - 1) * ground_tile_cells);
      const int end = std::min(low_.x + side_, middle.x + column * ground_tile_cells);
      const GroundTile* tile = tiles.tiles[tile_row + static_cast<std::size_t>(column)];
      if (tile)
        add(*tile, low_.y + y, begin, end);
      else
        first_.insert(first_.end(), static_cast<std::size_t>(std::max(0, end - begin)), first_.back());
    }
  }
  ways_m_.reserve(leaders_.size() * leaders_.size());
  for (const PatchId from : leaders_)
    for (const PatchId to : leaders_) ways_m_.push_back(near.way_m(from, to));
}

void GroundWindow::add(const GroundTile& tile, int row, int column_begin, int column_end) {
  for (int x = column_begin; x < column_end; ++x) {
    const std::size_t cell = GroundTile::index(x - tile.low.x, row - tile.low.y);
    for (std::uint32_t i = tile.first[cell]; i < tile.first[cell + 1]; ++i) {
      cells_.push_back({x, row});
      leader_.push_back(number_of(tile.layers[i].leader));
      occupied_.push_back(tile.layers[i].occupied ? 1 : 0);
    }
    first_.push_back(static_cast<NodeId>(cells_.size()));
  }
}

/// That of the node before as a rule: a stretch of cells has one leader.
std::uint16_t GroundWindow::number_of(PatchId leader) {
  if (!leader_.empty() && leaders_[leader_.back()] == leader) return leader_.back();
  const auto found = std::ranges::find(leaders_, leader);
  const auto number = static_cast<std::uint16_t>(found - leaders_.begin());
  if (found == leaders_.end()) leaders_.push_back(leader);
  return number;
}

/// Of some nodes, the one whose leader is nearest to a leader along relations; -1: none is near.
NodeId GroundWindow::nearest(std::uint16_t leader, NodeId first, NodeId last) const {
  const float* ways_m = ways_m_.data() + leader * leaders_.size();
  NodeId best = -1;
  float least = std::numeric_limits<float>::infinity();
  for (NodeId node = first; node < last; ++node) {
    const float way_m = ways_m[leader_[index(node)]];
    if (!(way_m < least)) continue;
    least = way_m;
    best = node;
  }
  return best;
}

}  // namespace isthmus
