#pragma once

#include <map>
#include <memory>
#include <set>
#include <vector>

#include "server/paths/ground/tile_surface.hpp"

namespace isthmus {

/// Keeps the surfaces of an island's tiles up to date: one is made again only where the tile or one around it
/// changed.
class IslandSurface {
 public:
  using Tiles = std::map<TilePlace, std::shared_ptr<const GroundTile>>;

  /// `near_changed`: places of which patches came near one another along relations, or are it no more.
  /// Whether any surface changed.
  bool update(const Tiles& tiles, const NearPatches& near, const std::set<TilePlace>& near_changed = {});

  /// By row and column.
  std::vector<std::shared_ptr<const TileSurface>> surfaces() const;

 private:
  struct Kept {
    std::shared_ptr<const GroundTile> tile;    ///< as it was given
    std::shared_ptr<const GroundTile> filled;  ///< with layers in its gaps
    std::shared_ptr<const TileSurface> surface;
  };

  using Changes = std::map<TilePlace, CellBox>;  ///< where, on a tile

  Changes take(const Tiles& tiles);
  Changes fill(const Changes& tiles, const NearPatches& near);
  void measure(const Changes& filled, const NearPatches& near);
  /// The tiles that there are, of which something lies so near to a change.
  std::set<TilePlace> places_within(int cells, const Changes& changes) const;

  std::map<TilePlace, Kept> kept_;
};

}  // namespace isthmus
