#include "server/paths/ground/ground.hpp"

#include <algorithm>

namespace isthmus {
namespace {

template <class T>
void append(std::vector<T>& all, const std::vector<T>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

}  // namespace

Ground::Ground(std::vector<std::shared_ptr<const TileSurface>> surfaces,
               std::shared_ptr<const NearPatches> near)
    : surfaces_(std::move(surfaces)), near_(std::move(near)) {
  std::size_t nodes = 0;
  for (const auto& surface : surfaces_) {
    first_node_.push_back(static_cast<NodeId>(nodes));
    nodes += surface->tile->layers.size();
  }
  cells_.reserve(nodes);
  layers_.reserve(nodes);
  wall_m_.reserve(nodes);
  unseen_m_.reserve(nodes);
  borders_on_unseen_.reserve(nodes);
  for (const auto& surface : surfaces_) add(*surface);
  find_tiles();
}

void Ground::add(const TileSurface& surface) {
  const GroundTile& tile = *surface.tile;
  for (std::size_t cell = 0; cell + 1 < tile.first.size(); ++cell) {
    const auto x = static_cast<std::int32_t>(cell % ground_tile_cells);
    const auto y = static_cast<std::int32_t>(cell / ground_tile_cells);
    for (std::uint32_t i = tile.first[cell]; i < tile.first[cell + 1]; ++i)
      cells_.push_back({tile.low.x + x, tile.low.y + y});
  }
  append(layers_, tile.layers);
  append(wall_m_, surface.wall_m);
  append(unseen_m_, surface.unseen_m);
  append(borders_on_unseen_, surface.borders_on_unseen);
}

void Ground::find_tiles() {
  if (surfaces_.empty()) return;
  constexpr auto most = std::numeric_limits<std::int32_t>::max();
  low_tile_ = {most, most};
  Cell high{-most, -most};
  for (const auto& surface : surfaces_) {
    const auto [row, column] = place_of(*surface->tile);
    low_tile_ = {std::min(low_tile_.x, column), std::min(low_tile_.y, row)};
    high = {std::max(high.x, column), std::max(high.y, row)};
  }
  columns_ = high.x - low_tile_.x + 1;
  rows_ = high.y - low_tile_.y + 1;
  tile_at_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), -1);
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    const auto [row, column] = place_of(*surfaces_[i]->tile);
    tile_at_[static_cast<std::size_t>(row - low_tile_.y) * static_cast<std::size_t>(columns_) +
             static_cast<std::size_t>(column - low_tile_.x)] = static_cast<std::int32_t>(i);
  }
}

std::int32_t Ground::tile_index(const Cell& cell) const {
  const int column = tile_of(cell.x) - low_tile_.x, row = tile_of(cell.y) - low_tile_.y;
  if (column < 0 || column >= columns_ || row < 0 || row >= rows_) return -1;
  return tile_at_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                  static_cast<std::size_t>(column)];
}

std::pair<NodeId, NodeId> Ground::at(const Cell& cell) const {
  const std::int32_t tile = tile_index(cell);
  if (tile < 0) return {0, 0};
  const GroundTile& cells = *surfaces_[static_cast<std::size_t>(tile)]->tile;
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
