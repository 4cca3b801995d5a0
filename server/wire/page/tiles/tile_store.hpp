#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/engine/record/map_copy.hpp"
#include "server/wire/page/tiles/tile.hpp"

namespace isthmus {

/// The grids of all islands as tiles with versions. A tile gets a new version when patches on it come, go or
/// move by half a cell; it is drawn when somebody asks for it, once for each version. Any thread; tiles are
/// drawn one at a time.
class TileStore {
 public:
  /// Versions count on from this number: one that no earlier run has come to, so that what viewers kept of
  /// another run is not taken for this one's.
  explicit TileStore(std::int64_t first_version) : version_(first_version) {}

  void update(const MapCopy& map);

  struct Extent {
    std::int64_t version = 0;  ///< of its newest tile
    MapBox box;                ///< of all its patches
  };
  std::map<IslandId, Extent> islands() const;

  struct Version {
    TileKey key;
    std::int64_t version = 0;
  };
  /// The tiles of all zooms that changed after a version, by key; none of an island that is not there.
  std::vector<Version> changed_since(IslandId island, std::int64_t version) const;

  struct Image {
    std::int64_t version = 0;
    std::shared_ptr<const std::string> png;
  };
  /// A tile as it is now; nothing where there is none.
  std::optional<Image> image(IslandId island, const TileKey& key);

 private:
  struct Shown {
    PatchPtr patch;
    Pose map_from_patch;
    IslandId island;  ///< none: not shown
    MapBox box;
    std::pair<TileKey, TileKey> tiles;
  };
  struct Tile {
    std::int64_t version = 0;
    std::set<PatchId> patches;       ///< of zoom 0
    std::int64_t drawn_version = 0;  ///< of the pixels; 0: not drawn yet
    TilePixels pixels;
    std::shared_ptr<const std::string> png;  ///< of the pixels; none: not encoded yet
  };
  struct Island {
    Extent extent;
    std::map<TileKey, Tile> tiles;
    std::int64_t patches = 0;
  };

  void show(PatchId id, const PlacedPatch& placed, const PatchPtr& patch, IslandId island);
  void hide(PatchId id);
  void measure();
  void touch(Island& island, TileKey key);
  Tile* find(IslandId island, const TileKey& key);
  std::optional<std::vector<std::uint8_t>> pixels(IslandId island, const TileKey& key);
  std::vector<std::uint8_t> drawn(IslandId island, const TileKey& key, const std::set<PatchId>& patches);

  std::mutex drawing_;        ///< taken before the other
  mutable std::mutex mutex_;  ///< of all below
  std::int64_t version_;
  std::vector<Shown> shown_;  ///< by patch id
  std::map<IslandId, Island> islands_;
};

}  // namespace isthmus
