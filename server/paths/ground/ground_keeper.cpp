#include "server/paths/ground/ground_keeper.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

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

bool same_patches(const std::vector<TilePatch>& a, const std::vector<TilePatch>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const TilePatch& one, const TilePatch& other) {
    return one.id == other.id && one.raster == other.raster;
  });
}

}  // namespace

void GroundKeeper::update(const MapCopy& map) {
  follow_robots(map);
  cut_into_cells(map);
  near_ = std::make_shared<const NearPatches>(map, near_m);
  std::map<Key, std::vector<TilePatch>> spread_out = spread(map);
  std::set<IslandId> changed;
  std::erase_if(tiles_, [&](const auto& kept) {
    if (spread_out.contains(kept.first)) return false;
    changed.insert(std::get<IslandId>(kept.first));
    return true;
  });
  for (auto& [key, patches] : spread_out)
    if (keep_tile(key, std::move(patches), *near_)) changed.insert(std::get<IslandId>(key));
  for (const IslandId island : changed) grounds_.erase(island);
  std::map<IslandId, std::vector<std::shared_ptr<const GroundTile>>> tiles;
  for (const auto& [key, kept] : tiles_)
    if (changed.contains(std::get<IslandId>(key))) tiles[std::get<IslandId>(key)].push_back(kept.tile);
  for (auto& [island, of_island] : tiles)
    grounds_[island] = std::make_shared<const Ground>(std::move(of_island), near_);
}

std::shared_ptr<const Ground> GroundKeeper::ground(IslandId island) const {
  const auto found = grounds_.find(island);
  return found == grounds_.end() ? nullptr : found->second;
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

std::map<GroundKeeper::Key, std::vector<TilePatch>> GroundKeeper::spread(const MapCopy& map) const {
  std::map<Key, std::vector<TilePatch>> tiles;
  for (std::size_t i = 0; i < rasters_.size(); ++i) {
    if (!rasters_[i]) continue;
    const PatchId id{static_cast<std::int32_t>(i)};
    const IslandId island = map.graph.island(id);
    const Cell low = rasters_[i]->low(), high = rasters_[i]->high();
    for (std::int32_t row = tile_of(low.y); row <= tile_of(high.y - 1); ++row)
      for (std::int32_t column = tile_of(low.x); column <= tile_of(high.x - 1); ++column)
        tiles[{island, row, column}].push_back({id, rasters_[i]});
  }
  return tiles;
}

/// Whether the tile had to be made again.
bool GroundKeeper::keep_tile(const Key& key, std::vector<TilePatch> patches, const NearPatches& near) {
  std::vector<std::uint8_t> pairs = near_pairs(patches, near);
  Kept& kept = tiles_[key];
  if (kept.tile && kept.near == pairs && same_patches(kept.patches, patches)) return false;
  const Cell low{std::get<2>(key) * ground_tile_cells, std::get<1>(key) * ground_tile_cells};
  kept.tile = std::make_shared<const GroundTile>(make_ground_tile(low, patches, pairs));
  kept.patches = std::move(patches);
  kept.near = std::move(pairs);
  return true;
}

}  // namespace isthmus
