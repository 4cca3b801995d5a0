#include "server/wire/page/tiles/tile_store.hpp"

#include <algorithm>
#include <cmath>

#include "server/output/format/png.hpp"

namespace isthmus {
namespace {

/// A patch that moved by less leaves the same cells, but for those whose centres it just reaches: half a
/// cell, at 5 m from the patch.
constexpr double tiles_still_m = 0.5 * finest_cell_m;
constexpr double tiles_still_rad = tiles_still_m / 5;

bool leaves_the_same_cells(const Pose& a, const Pose& b) {
  return std::hypot(a.x - b.x, a.y - b.y) < tiles_still_m &&
         std::abs(wrap_angle(a.yaw - b.yaw)) < tiles_still_rad;
}

template <class Visit>
void for_each(const std::pair<TileKey, TileKey>& tiles, const Visit& visit) {
  for (int y = tiles.first.y; y <= tiles.second.y; ++y) {
    for (int x = tiles.first.x; x <= tiles.second.x; ++x) visit(TileKey{0, x, y});
  }
}

}  // namespace

void TileStore::update(const MapCopy& map) {
  const std::lock_guard lock(mutex_);
  version_ += 1;
  shown_.resize(map.patches.size());
  for (const std::vector<PatchId>& island : map.graph.islands()) {
    for (const PatchId id : island) {
      const auto i = static_cast<std::size_t>(id.value);
      const PlacedPatch placed{*map.patches[i], map.poses[i]};
      if (!is_on_grid(placed) || std::ranges::binary_search(map.left_out, id)) {
        hide(id);
      } else if (shown_[i].island != island.front() ||
                 !leaves_the_same_cells(shown_[i].map_from_patch, map.poses[i])) {
        hide(id);
        show(id, placed, map.patches[i], island.front());
      }
    }
  }
  std::erase_if(islands_, [](const auto& island) { return island.second.patches == 0; });
  measure();
}

void TileStore::measure() {
  for (auto& [id, island] : islands_) island.extent.box = {};
  for (const Shown& shown : shown_) {
    if (!shown.island.valid()) continue;
    MapBox& box = islands_[shown.island].extent.box;
    box.include(shown.box.low);
    box.include(shown.box.high);
  }
}

void TileStore::show(PatchId id, const PlacedPatch& placed, const PatchPtr& patch, IslandId island) {
  const MapBox box = box_on_grid(placed);
  Shown& shown = shown_[static_cast<std::size_t>(id.value)];
  shown = {patch, placed.map_from_patch, island, box, tiles_under(box)};
  Island& on = islands_[island];
  on.patches += 1;
  for_each(shown.tiles, [&](const TileKey& key) {
    touch(on, key);
    on.tiles[key].patches.insert(id);
  });
}

void TileStore::hide(PatchId id) {
  Shown& shown = shown_[static_cast<std::size_t>(id.value)];
  if (!shown.island.valid()) return;
  Island& on = islands_[shown.island];
  on.patches -= 1;
  for_each(shown.tiles, [&](const TileKey& key) {
    touch(on, key);
    on.tiles[key].patches.erase(id);
  });
  shown = {};
}

/// The tile and those above it are another version from now on.
void TileStore::touch(Island& island, TileKey key) {
  island.extent.version = version_;
  for (; key.zoom >= coarsest_zoom; key = parent(key)) {
    Tile& tile = island.tiles[key];
    if (tile.version == version_) return;
    tile.version = version_;
  }
}

std::map<IslandId, TileStore::Extent> TileStore::islands() const {
  const std::lock_guard lock(mutex_);
  std::map<IslandId, Extent> extents;
  for (const auto& [id, island] : islands_) extents.emplace(id, island.extent);
  return extents;
}

std::vector<TileStore::Version> TileStore::changed_since(IslandId island, std::int64_t version) const {
  const std::lock_guard lock(mutex_);
  std::vector<Version> changed;
  const auto found = islands_.find(island);
  if (found == islands_.end()) return changed;
  for (const auto& [key, tile] : found->second.tiles) {
    if (tile.version > version) changed.push_back({key, tile.version});
  }
  return changed;
}

TileStore::Tile* TileStore::find(IslandId island, const TileKey& key) {
  const auto found = islands_.find(island);
  if (found == islands_.end()) return nullptr;
  const auto tile = found->second.tiles.find(key);
  return tile == found->second.tiles.end() ? nullptr : &tile->second;
}

std::optional<TileStore::Image> TileStore::image(IslandId island, const TileKey& key) {
  const auto kept = [&]() -> std::optional<Image> {
    const std::lock_guard lock(mutex_);
    const Tile* tile = find(island, key);
    if (!tile || !tile->png || tile->drawn_version != tile->version) return std::nullopt;
    return Image{tile->version, tile->png};
  };
  if (auto image = kept()) return image;
  const std::lock_guard one_at_a_time(drawing_);
  if (auto image = kept()) return image;
  const auto drawn = pixels(island, key);
  if (!drawn) return std::nullopt;
  auto png = std::make_shared<const std::string>(grey_png(tile_cells, tile_cells, *drawn));
  const std::lock_guard lock(mutex_);
  Tile* tile = find(island, key);
  if (!tile) return std::nullopt;
  tile->png = std::move(png);
  return Image{tile->drawn_version, tile->png};
}

/// Of a tile as it is when this begins; nothing where there is none.
std::optional<std::vector<std::uint8_t>> TileStore::pixels(IslandId island, const TileKey& key) {
  std::int64_t version = 0;
  std::set<PatchId> patches;
  {
    const std::lock_guard lock(mutex_);
    const Tile* tile = find(island, key);
    if (!tile) return std::nullopt;
    if (tile->drawn_version == tile->version) return tile->pixels.unpack();
    version = tile->version;
    patches = tile->patches;
  }
  std::vector<std::uint8_t> fresh;
  if (key.zoom == 0) {
    fresh = drawn(island, key, patches);
  } else {
    std::array<std::vector<std::uint8_t>, 4> parts;
    const std::array<TileKey, 4> keys = quarters(key);
    for (std::size_t i = 0; i < parts.size(); ++i)
      parts[i] = pixels(island, keys[i]).value_or(TilePixels().unpack());
    fresh = join_quarters(parts);
  }
  const std::lock_guard lock(mutex_);
  if (Tile* tile = find(island, key)) {
    tile->pixels = TilePixels(fresh);
    tile->drawn_version = version;
    tile->png = nullptr;
  }
  return fresh;
}

std::vector<std::uint8_t> TileStore::drawn(IslandId island, const TileKey& key,
                                           const std::set<PatchId>& patches) {
  std::vector<PatchPtr> kept;  // while they are drawn
  std::vector<PlacedPatch> placed;
  {
    const std::lock_guard lock(mutex_);
    for (const PatchId id : patches) {
      const Shown& shown = shown_[static_cast<std::size_t>(id.value)];
      if (shown.island != island) continue;  // since gone; the tile has a newer version
      kept.push_back(shown.patch);
      placed.push_back({*shown.patch, shown.map_from_patch});
    }
  }
  return render_tile(placed, key);
}

}  // namespace isthmus
