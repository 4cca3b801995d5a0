#include "server/paths/ground/ground.hpp"

#include <algorithm>
#include <map>

#include "server/paths/ground/distance_field.hpp"
#include "server/paths/ground/gaps.hpp"

namespace isthmus {
namespace {

/// The same with layers put into cells that had none.
GroundTile with_layers(const GroundTile& tile, const std::vector<std::pair<std::size_t, Layer>>& added) {
  GroundTile filled{tile.low, {0}, {}};
  filled.first.reserve(tile.first.size());
  filled.layers.reserve(tile.layers.size() + added.size());
  auto next = added.begin();
  for (std::size_t cell = 0; cell + 1 < tile.first.size(); ++cell) {
    filled.layers.insert(filled.layers.end(), tile.layers.begin() + tile.first[cell],
                         tile.layers.begin() + tile.first[cell + 1]);
    if (next != added.end() && next->first == cell) filled.layers.push_back((next++)->second);
    filled.first.push_back(static_cast<std::uint32_t>(filled.layers.size()));
  }
  return filled;
}

}  // namespace

Ground::Ground(std::vector<std::shared_ptr<const GroundTile>> tiles, std::shared_ptr<const NearPatches> near)
    : tiles_(std::move(tiles)), near_(std::move(near)) {
  lay_out();
  fill_gaps();
  measure();
}

/// Tiles are shared with other grounds: those with gaps are copied.
void Ground::fill_gaps() {
  std::map<std::size_t, std::vector<std::pair<std::size_t, Layer>>> layers;  // by tile: by cell, in order
  for (const GapCell& gap : find_gaps(*this)) {
    const std::int32_t tile = tile_index(gap.cell);
    if (tile < 0) continue;
    const Cell& low = tiles_[static_cast<std::size_t>(tile)]->low;
    layers[static_cast<std::size_t>(tile)].emplace_back(
        GroundTile::index(gap.cell.x - low.x, gap.cell.y - low.y), Layer{gap.leader, false, true});
  }
  if (layers.empty()) return;
  for (const auto& [tile, added] : layers)
    tiles_[tile] = std::make_shared<const GroundTile>(with_layers(*tiles_[tile], added));
  first_node_.clear();
  layers_.clear();
  cells_.clear();
  lay_out();
}

std::int32_t Ground::tile_index(const Cell& cell) const {
  const int column = tile_of(cell.x) - low_tile_.x, row = tile_of(cell.y) - low_tile_.y;
  if (column < 0 || column >= columns_ || row < 0 || row >= rows_) return -1;
  return tile_at_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(column)];
}

void Ground::lay_out() {
  if (tiles_.empty()) return;
  constexpr auto most = std::numeric_limits<std::int32_t>::max();
  Cell low{most, most}, high{-most, -most};
  for (const auto& tile : tiles_) {
    const Cell at{tile_of(tile->low.x), tile_of(tile->low.y)};
    low = {std::min(low.x, at.x), std::min(low.y, at.y)};
    high = {std::max(high.x, at.x), std::max(high.y, at.y)};
  }
  low_tile_ = low;
  columns_ = high.x - low.x + 1;
  rows_ = high.y - low.y + 1;
  tile_at_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), -1);
  for (std::size_t i = 0; i < tiles_.size(); ++i) {
    const GroundTile& tile = *tiles_[i];
    const int column = tile_of(tile.low.x) - low.x, row = tile_of(tile.low.y) - low.y;
    tile_at_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
             static_cast<std::size_t>(column)] = static_cast<std::int32_t>(i);
    first_node_.push_back(static_cast<NodeId>(layers_.size()));
    layers_.insert(layers_.end(), tile.layers.begin(), tile.layers.end());
    for (std::size_t cell = 0; cell + 1 < tile.first.size(); ++cell) {
      const auto x = static_cast<std::int32_t>(cell % ground_tile_cells);
      const auto y = static_cast<std::int32_t>(cell / ground_tile_cells);
      cells_.insert(cells_.end(), tile.first[cell + 1] - tile.first[cell], {tile.low.x + x, tile.low.y + y});
    }
  }
}

void Ground::measure() {
  std::vector<Source> walls, unseen;
  for (NodeId node = 0; node < static_cast<NodeId>(size()); ++node) {
    const Cell& own = cell(node);
    if (layer(node).occupied) walls.push_back({node, own});
    visit_beside(own, [&](const Cell& beside) {
      if (step(node, beside) < 0) unseen.push_back({node, beside});
    });
  }
  wall_m_ = distances_m(*this, walls, reach_m);
  // What one stretch does not show is known to another that is near to both.
  const auto is_unseen = [this](NodeId node, const Cell& cell) { return find(cell, layer(node).leader) < 0; };
  unseen_m_ = distances_m(*this, unseen, reach_m, is_unseen);
}

std::pair<NodeId, NodeId> Ground::at(const Cell& cell) const {
  const std::int32_t tile = tile_index(cell);
  if (tile < 0) return {0, 0};
  const GroundTile& cells = *tiles_[static_cast<std::size_t>(tile)];
  const std::size_t i = GroundTile::index(cell.x - cells.low.x, cell.y - cells.low.y);
  const NodeId first = first_node_[static_cast<std::size_t>(tile)];
  return {first + static_cast<NodeId>(cells.first[i]), first + static_cast<NodeId>(cells.first[i + 1])};
}

NodeId Ground::step(NodeId from, const Cell& to) const { return find(to, layer(from).leader); }

NodeId Ground::find(const Cell& cell, PatchId patch) const {
  const auto [first, last] = at(cell);
  NodeId best = -1;
  float least = std::numeric_limits<float>::infinity();
  for (NodeId node = first; node < last; ++node) {
    const float way = near_->way_m(patch, layer(node).leader);
    if (!(way < least)) continue;
    least = way;
    best = node;
  }
  return best;
}

}  // namespace isthmus
