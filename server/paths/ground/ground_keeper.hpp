#pragma once

#include <map>
#include <memory>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "server/paths/ground/ground.hpp"

namespace isthmus {

/// Keeps the grounds of a map's islands up to date: what a patch shows is cut into cells again only where its
/// pose has moved by half a cell or a robot has stood somewhere else in it, a tile is made again only where
/// its patches, or how they are related, changed, and a ground only where one of its tiles did.
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
  using Key = std::tuple<IslandId, std::int32_t, std::int32_t>;  ///< of a tile: island, row, column
  struct Kept {
    std::vector<TilePatch> patches;
    std::vector<std::uint8_t> near;
    std::shared_ptr<const GroundTile> tile;
  };

  /// Where robots stood in a patch's frame, a decimetre apart.
  struct Driven {
    std::set<std::pair<std::int32_t, std::int32_t>> decimetres;
    std::vector<Eigen::Vector2d> points;
    bool is_new = false;
  };

  void follow_robots(const MapCopy& map);
  void cut_into_cells(const MapCopy& map);
  std::map<Key, std::vector<TilePatch>> spread(const MapCopy& map) const;
  bool keep_tile(const Key& key, std::vector<TilePatch> patches, const NearPatches& near);

  std::shared_ptr<const TrajectoryStore> trajectory_;
  std::size_t rows_ = 0;                                     // of the trajectory, that were followed
  std::vector<Driven> driven_;                               // by patch id
  std::vector<std::shared_ptr<const PatchRaster>> rasters_;  // by patch id; none: not on the ground
  std::shared_ptr<const NearPatches> near_ = std::make_shared<const NearPatches>();
  std::map<Key, Kept> tiles_;
  std::map<IslandId, std::shared_ptr<const Ground>> grounds_;
};

}  // namespace isthmus
