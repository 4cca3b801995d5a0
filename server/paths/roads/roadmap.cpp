#include "server/paths/roads/roadmap.hpp"

#include <unordered_map>
#include <utility>

#include "server/paths/ground/cell_line.hpp"

namespace isthmus {

Roadmap::Roadmap(std::shared_ptr<const Ground> ground, const Footprint& footprint,
                 std::span<const Zone> zones, const Roadmap* before)
    : ground_(std::move(ground)), footprint_(footprint) {
  make_tiles(zones, before);
  const Pairs pairs = join_tiles();
  std::vector<Cell> middles;
  std::vector<Eigen::Vector2d> points_m;
  middles.reserve(middle_.size());
  points_m.reserve(middle_.size());
  for (const NodeId middle : middle_) {
    middles.push_back(ground_->cell(middle));
    points_m.push_back(ground_->centre(middle));
  }
  graph_ = PointGraph(std::move(points_m), pairs);
  regions_ = Regions(middles, graph_);
}

void Roadmap::make_tiles(std::span<const Zone> zones, const Roadmap* before) {
  // A fit may move a zone by so much before a roadmap is made again (`are_alike`).
  constexpr double moved_m = 0.5 * ground_cell_m;
  const KeptOutCells kept_out(zones, footprint_.radius_m + off_centre_m + moved_m);
  std::unordered_map<const TileSurface*, std::shared_ptr<const RoadTile>> made;
  if (before)
    for (const auto& tile : before->tiles_) made.emplace(tile->surface.get(), tile);
  for (const auto& surface : ground_->surfaces()) {
    std::shared_ptr<const RoadTile>& tile = made[surface.get()];
    if (!tile)
      tile =
          std::make_shared<const RoadTile>(make_road_tile(surface, footprint_, kept_out, *ground_->near()));
    tiles_.push_back(tile);
  }
}

/// Numbers the tiles' squares on. Which of them are beside which, within tiles and across.
Roadmap::Pairs Roadmap::join_tiles() {
  Pairs pairs;
  square_.reserve(ground_->size());
  open_.reserve(ground_->size());
  for (std::size_t i = 0; i < tiles_.size(); ++i) {
    const RoadTile& tile = *tiles_[i];
    const auto first = static_cast<SquareId>(middle_.size());
    for (const SquareId square : tile.square) square_.push_back(square < 0 ? square : first + square);
    for (const NodeId middle : tile.middle) middle_.push_back(ground_->first_node(i) + middle);
    for (const auto& [from, to] : tile.beside) pairs.emplace_back(first + from, first + to);
    open_.insert(open_.end(), tile.open_cells.begin(), tile.open_cells.end());
  }
  for (std::size_t i = 0; i < tiles_.size(); ++i) join_across(i, pairs);
  return pairs;
}

void Roadmap::join_across(std::size_t tile, Pairs& pairs) const {
  const Cell& low = tiles_[tile]->surface->tile->low;
  constexpr int last = ground_tile_cells - 1;
  const auto join = [&](int x, int y) {
    const auto [begin, end] = ground_->at({low.x + x, low.y + y});
    for (NodeId node = begin; node < end; ++node) {
      if (!fits(node)) continue;
      visit_beside(ground_->cell(node), [&](const Cell& beside) {
        if (tile_of(beside.x) == tile_of(low.x) && tile_of(beside.y) == tile_of(low.y)) return;
        const NodeId next = ground_->step(node, beside);
        if (next < 0 || !fits(next)) return;
        pairs.emplace_back(square(node), square(next));
        pairs.emplace_back(square(next), square(node));
      });
    }
  };
  for (int i = 0; i <= last; ++i) {
    join(i, 0);
    join(i, last);
  }
  for (int i = 1; i < last; ++i) {
    join(0, i);
    join(last, i);
  }
}

std::optional<NodeId> Roadmap::straight(NodeId from, const Cell& to) const {
  CellLine line(ground_->cell(from), to);
  NodeId node = from;
  while (!line.done()) {
    const std::int32_t open = open_cells(node);
    if (open > 1) {
      node = ground_->only(line.leap(open));
    } else {
      node = ground_->step(node, line.step());
      if (node < 0 || !fits(node)) return std::nullopt;
    }
  }
  return node;
}

}  // namespace isthmus
