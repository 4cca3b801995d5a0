#include "server/paths/ground/island_surface.hpp"

#include <utility>

namespace isthmus {
namespace {

CellBox tile_box(const TilePlace& place) {
  const Cell low{place.second * ground_tile_cells, place.first * ground_tile_cells};
  return {low, {low.x + ground_tile_cells, low.y + ground_tile_cells}};
}

template <class TileAt>
TilesAround tiles_around(const TilePlace& place, const TileAt& tile_at) {
  TilesAround around;
  for (int i = 0; i < 9; ++i)
    around.tiles[static_cast<std::size_t>(i)] = tile_at({place.first + i / 3 - 1, place.second + i % 3 - 1});
  return around;
}

}  // namespace

bool IslandSurface::update(const Tiles& tiles, const NearPatches& near,
                           const std::set<TilePlace>& near_changed) {
  Changes changed = take(tiles);
  for (const TilePlace& place : near_changed) changed.insert_or_assign(place, tile_box(place));
  if (changed.empty()) return false;
  Changes filled = fill(changed, near);
  for (const TilePlace& place : near_changed) filled.insert_or_assign(place, tile_box(place));
  measure(filled, near);
  return true;
}

/// Where tiles came, went, or are others now.
IslandSurface::Changes IslandSurface::take(const Tiles& tiles) {
  Changes changed;
  std::erase_if(kept_, [&](const auto& kept) {
    if (tiles.contains(kept.first)) return false;
    changed.emplace(kept.first, tile_box(kept.first));
    return true;
  });
  for (const auto& [place, tile] : tiles) {
    const auto before = std::exchange(kept_[place].tile, tile);
    const auto change = before && before != tile ? difference(*before, *tile) : std::nullopt;
    if (!before)
      changed.emplace(place, tile_box(place));
    else if (change)
      changed.emplace(place, *change);
  }
  return changed;
}

/// Fills the gaps of tiles anew. Where that makes them others than they were, and where they are gone.
IslandSurface::Changes IslandSurface::fill(const Changes& tiles, const NearPatches& near) {
  Changes changed;
  for (const auto& [place, box] : tiles)
    if (!kept_.contains(place)) changed.emplace(place, box);
  const auto tile_at = [this](const TilePlace& at) {
    const auto found = kept_.find(at);
    return found == kept_.end() ? nullptr : found->second.tile.get();
  };
  for (const TilePlace& place : places_within(gap_margin_cells, tiles)) {
    Kept& kept = kept_.at(place);
    std::shared_ptr<const GroundTile> filled = with_gaps(tiles_around(place, tile_at), near);
    if (!filled) filled = kept.tile;
    const auto before = std::exchange(kept.filled, std::move(filled));
    const auto change = before ? difference(*before, *kept.filled) : tile_box(place);
    if (change) changed.emplace(place, *change);
  }
  return changed;
}

void IslandSurface::measure(const Changes& filled, const NearPatches& near) {
  const auto tile_at = [this](const TilePlace& at) {
    const auto found = kept_.find(at);
    return found == kept_.end() ? nullptr : found->second.filled.get();
  };
  for (const TilePlace& place : places_within(measured_margin_cells, filled)) {
    Kept& kept = kept_.at(place);
    kept.surface =
        std::make_shared<const TileSurface>(measure_surface(kept.filled, tiles_around(place, tile_at), near));
  }
}

std::set<TilePlace> IslandSurface::places_within(int cells, const Changes& changes) const {
  std::set<TilePlace> places;
  for (const auto& [place, box] : changes)
    for (std::int32_t row = tile_of(box.low.y - cells); row <= tile_of(box.high.y - 1 + cells); ++row)
      for (std::int32_t column = tile_of(box.low.x - cells); column <= tile_of(box.high.x - 1 + cells);
           ++column)
        if (kept_.contains({row, column})) places.emplace(row, column);
  return places;
}

std::vector<std::shared_ptr<const TileSurface>> IslandSurface::surfaces() const {
  std::vector<std::shared_ptr<const TileSurface>> surfaces;
  surfaces.reserve(kept_.size());
  for (const auto& [place, kept] : kept_) surfaces.push_back(kept.surface);
  return surfaces;
}

}  // namespace isthmus
