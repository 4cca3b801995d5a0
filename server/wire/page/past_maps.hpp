#pragma once

#include <cstdint>
#include <filesystem>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "server/wire/journal/snapshot.hpp"
#include "server/wire/page/map/packed_patches.hpp"
#include "server/wire/page/tiles/tile_store.hpp"

namespace isthmus {

/// A map as it was at a snapshot.
struct PastMap {
  /// Versions of tiles and islands count on from `version`.
  PastMap(int of_snapshot, const SnapshotSummary& summary, const MapCopy& copy, std::int64_t version);

  int snapshot;
  ShownMap shown;
  TileStore tiles;
  PackedPatches packed;
  SharedText text;  ///< JSON; the room's README lists the fields
};

/// The maps that a journal's snapshots hold, read when somebody asks, in the thread that does, one at a time.
/// The two used last are kept: each may take as much memory as the live map. Any thread.
class PastMaps {
 public:
  static constexpr std::size_t max_kept = 2;

  /// `directory`: of the journal; empty: there is none.
  PastMaps(std::string directory, std::int64_t first_version);

  /// The snapshots there are, by their files' names; none where the directory cannot be read.
  std::vector<int> snapshots() const;

  /// JSON: of each of them `snapshot`, `time` (s, of its last event), `events`, `end` (of its newest scan:
  /// tenths of a second after the first patch of the map as it is `now`); or `error`, where it is of no use.
  /// Each is looked at once.
  std::string list(const ShownMap& now);

  struct Found {
    std::shared_ptr<PastMap> map;  ///< none: see below
    int status = 200;  ///< of HTTP: 404 there is none, 500 it is of no use, 503 another is being read
    std::string why;
  };
  Found find(int snapshot);

 private:
  /// What was found in a file.
  struct Entry {
    std::filesystem::file_time_type written;
    SnapshotSummary summary;
    std::string error;  ///< or why it is of no use
  };

  Entry entry_of(int snapshot, const std::string& path);
  std::shared_ptr<PastMap> kept(int snapshot);
  Found read(int snapshot);

  std::string directory_;
  std::int64_t first_version_;
  std::mutex reading_;
  std::mutex indexing_;
  std::map<int, Entry> entries_;  ///< under indexing_
  std::mutex keeping_;
  std::list<std::shared_ptr<PastMap>> kept_;  ///< the one used last first; under keeping_
};

}  // namespace isthmus
