#include "server/paths/ground/ground_keeper.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "server/paths/ground/scan_parts.hpp"

namespace isthmus {
namespace {

/// How far a raster's cells would move, in metres, as far out as most of them are.
double moved_m(const Pose& before, const Pose& after) {
  constexpr double arm_m = 10;
  const Eigen::Vector3d by = wrapped_difference(after, before);
  return by.head<2>().norm() + arm_m * std::abs(by.z());
}

/// A robot is localised in a patch that it lies in: farther out it is none of the patch's business.
constexpr double farthest_stood_m = 30;

/// The tiles that a raster lies on, from `low` to `high`.
struct TileRange {
  TilePlace low, high;
};

TileRange tiles_of(const PatchRaster& raster) {
  const Cell low = raster.low(), high = raster.high();
  return {{tile_of(low.y), tile_of(low.x)}, {tile_of(high.y - 1), tile_of(high.x - 1)}};
}

bool same_patches(const std::vector<TilePatch>& a, const std::vector<TilePatch>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const TilePatch& one, const TilePatch& other) {
    return one.id == other.id && one.raster == other.raster && one.part == other.part;
  });
}

}  // namespace

void GroundKeeper::update(const MapCopy& map) {
  follow_robots(map);
  cut_into_cells(map);
  const auto before = std::exchange(near_, std::make_shared<const NearPatches>(near_->kept_up(map)));
  Places near_changed = changed_nearness(map, *before);
  std::map<IslandId, Patches> islands = spread(map);
  std::erase_if(islands_, [&](const auto& kept) { return !islands.contains(kept.first); });
  for (auto& [island, patches] : islands) keep_up(islands_[island], std::move(patches), near_changed[island]);
}

std::shared_ptr<const Ground> GroundKeeper::ground(IslandId island) const {
  const auto found = islands_.find(island);
  return found == islands_.end() ? nullptr : found->second.ground;
}

void GroundKeeper::follow_robots(const MapCopy& map) {
  if (map.trajectory != trajectory_) {
    trajectory_ = map.trajectory;
    rows_ = 0;
  }
  driven_.resize(map.patches.size());
  while (trajectory_ && rows_ < map.trajectory_rows) {
    constexpr std::size_t at_once = 10'000;
    const auto rows = trajectory_->read(rows_, std::min(at_once, map.trajectory_rows - rows_));
    if (rows.empty()) return;  // the disk refused them
    rows_ += rows.size();
    for (const TrajectoryRow& row : rows) {
      if (!row.patch.valid() || static_cast<std::size_t>(row.patch.value) >= driven_.size()) continue;
      Driven& driven = driven_[static_cast<std::size_t>(row.patch.value)];
      const Eigen::Vector2d point = position(row.patch_from_robot);
      if (!(point.norm() <= farthest_stood_m)) continue;
      const Eigen::Vector2i decimetre = (10 * point).array().floor().cast<int>();
      if (!driven.decimetres.emplace(decimetre.x(), decimetre.y()).second) continue;
      driven.points.push_back(point);
      driven.is_new = true;
    }
  }
}

void GroundKeeper::cut_into_cells(const MapCopy& map) {
  rasters_.resize(map.patches.size());
  for (std::size_t i = 0; i < map.patches.size(); ++i) {
    const PlacedPatch placed{*map.patches[i], map.poses[i]};
    std::shared_ptr<const PatchRaster>& raster = rasters_[i];
    const bool left_out = std::binary_search(map.left_out.begin(), map.left_out.end(), placed.patch.id);
    if (left_out || !is_on_grid(placed)) {
      raster.reset();
      continue;
    }
    const bool stays =
        raster && moved_m(raster->map_from_patch(), placed.map_from_patch) <= 0.5 * ground_cell_m;
    if (stays && !driven_[i].is_new) continue;
    raster = std::make_shared<const PatchRaster>(placed, driven_[i].points);
    driven_[i].is_new = false;
  }
}

std::map<IslandId, GroundKeeper::Patches> GroundKeeper::spread(const MapCopy& map) const {
  std::map<IslandId, Patches> islands;
  const std::vector<PatchId> parts = scan_parts(map);
  for (std::size_t i = 0; i < rasters_.size(); ++i) {
    if (!rasters_[i]) continue;
    const PatchId id{static_cast<std::int32_t>(i)};
    Patches& patches = islands[map.graph.island(id)];
    const TileRange range = tiles_of(*rasters_[i]);
    for (std::int32_t row = range.low.first; row <= range.high.first; ++row)
      for (std::int32_t column = range.low.second; column <= range.high.second; ++column)
        patches[{row, column}].push_back({id, rasters_[i], parts[i]});
  }
  return islands;
}

/// The places on or beside which both of two patches lie that came near one another, or are it no more.
GroundKeeper::Places GroundKeeper::changed_nearness(const MapCopy& map, const NearPatches& before) const {
  Places places;
  for (const auto& [a, b] : near_->changes(before)) {
    const auto& one = rasters_[static_cast<std::size_t>(a.value)];
    const auto& other = rasters_[static_cast<std::size_t>(b.value)];
    if (!one || !other || map.graph.island(a) != map.graph.island(b)) continue;
    const TileRange around_one = tiles_of(*one), around_other = tiles_of(*other);
    const auto low = [&](auto of) { return std::max(of(around_one.low), of(around_other.low)) - 1; };
    const auto high = [&](auto of) { return std::min(of(around_one.high), of(around_other.high)) + 1; };
    const auto row = [](const TilePlace& place) { return place.first; };
    const auto column = [](const TilePlace& place) { return place.second; };
    for (std::int32_t y = low(row); y <= high(row); ++y)
      for (std::int32_t x = low(column); x <= high(column); ++x) places[map.graph.island(a)].emplace(y, x);
  }
  return places;
}

void GroundKeeper::keep_up(Kept& kept, Patches patches, const std::set<TilePlace>& near_changed) const {
  std::erase_if(kept.tiles, [&](const auto& tile) { return !patches.contains(tile.first); });
  for (const auto& [place, on_tile] : patches) {
    std::shared_ptr<const GroundTile>& tile = kept.tiles[place];
    if (tile && !near_changed.contains(place) && same_patches(kept.patches[place], on_tile)) continue;
    const Cell low{place.second * ground_tile_cells, place.first * ground_tile_cells};
    tile = std::make_shared<const GroundTile>(make_ground_tile(low, on_tile, near_pairs(on_tile, *near_)));
  }
  kept.patches = std::move(patches);
  if (kept.surface.update(kept.tiles, *near_, near_changed))
    kept.ground = std::make_shared<const Ground>(kept.surface.surfaces(), near_);
}

}  // namespace isthmus
