#pragma once

#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "server/paths/ground/ground.hpp"
#include "server/paths/ground/island_surface.hpp"

namespace isthmus {

/// Keeps the grounds of a map's islands up to date: what a patch shows is cut into cells again only where its
/// pose has moved by half a cell or a robot has stood somewhere else in it, a tile is made again only where
/// its patches, or how they are related, changed, and of a ground only what lies around such a tile.
class GroundKeeper {
 public:
  /// Patches that are farther from one another along relations may have drifted apart: they make layers of
  /// their own. In metres.
  static constexpr double near_m = 60;

  void update(const MapCopy& map);

  /// Nothing for an island that is not there, or that has no ground.
  std::shared_ptr<const Ground> ground(IslandId island) const;
  /// Of the map that it was kept up to date with last.
  const std::shared_ptr<const NearPatches>& near() const { return near_; }

 private:
  using Patches = std::map<TilePlace, std::vector<TilePatch>>;  ///< that lie on the tiles of an island
  using Places = std::map<IslandId, std::set<TilePlace>>;
  struct Kept {
    Patches patches;
    IslandSurface::Tiles tiles;
    IslandSurface surface;
    std::shared_ptr<const Ground> ground;
  };

  /// Where robots stood in a patch's frame, a decimetre apart.
  struct Driven {
    std::set<std::pair<std::int32_t, std::int32_t>> decimetres;
    std::vector<Eigen::Vector2d> points;
    bool is_new = false;
  };

  void follow_robots(const MapCopy& map);
  void cut_into_cells(const MapCopy& map);
  std::map<IslandId, Patches> spread(const MapCopy& map) const;
  Places changed_nearness(const MapCopy& map, const NearPatches& before) const;
  void keep_up(Kept& kept, Patches patches, const std::set<TilePlace>& near_changed) const;

  std::shared_ptr<const TrajectoryStore> trajectory_;
  std::size_t rows_ = 0;                                     // of the trajectory, that were followed
  std::vector<Driven> driven_;                               // by patch id
  std::vector<std::shared_ptr<const PatchRaster>> rasters_;  // by patch id; none: not on the ground
  std::shared_ptr<const NearPatches> near_ = std::make_shared<const NearPatches>(MapCopy{}, near_m);
  std::map<IslandId, Kept> islands_;
};

}  // namespace isthmus
