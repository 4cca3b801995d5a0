#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/engine/engine.hpp"
#include "server/feature_maps/feature_estimator.hpp"
#include "server/wire/file/digest.hpp"
#include "server/wire/journal/frames/segment_header.hpp"
#include "server/wire/message/server_configuration.hpp"
#include "server/wire/watch/robot_monitor.hpp"

namespace isthmus {

/// Of what features an estimator's maps are; none: the manifold map.
std::optional<FeatureMapKind> feature_kind(EstimatorKind estimator);

/// What the events of a journal made, up to the end of a segment.
struct ServedMap {
  Engine engine;                               ///< but where there are
  std::unique_ptr<FeatureEstimator> features;  ///< maps of features, as the configuration says
  ChannelNames channels = {};                  ///< of its configuration
  RobotMonitor monitor;
  std::int64_t events = 0;                   ///< of the journal, those too damaged to be read included
  std::int64_t last_utime = 0;               ///< receive time of the last one; 0: none
  std::vector<std::int64_t> set_aside = {};  ///< of the events, those that it was made without; rising

  /// Whatever takes the events.
  Estimator& estimator() { return features ? static_cast<Estimator&>(*features) : engine; }
  const Estimator& estimator() const { return features ? static_cast<const Estimator&>(*features) : engine; }
  /// Before the configuration, which must parse, is taken as an event.
  void choose_estimator(const std::string& toml);
};

/// A part of the trajectory's rows, in a file of its own: rows never change, so that no snapshot need write
/// those again that were there before it.
struct TrajectoryPart {
  std::int32_t segment = 0;  ///< the file's number
  std::uint64_t rows = 0;
  Digest sha256{};  ///< of what the file holds

  auto members() { return std::tie(segment, rows, sha256); }
};

/// A snapshot that was read.
struct Snapshot {
  JournalPlace place;  ///< of the journal that it was made of
  ServedMap map;
  std::vector<TrajectoryPart> trajectory;  ///< in order
};

/// Reads a snapshot and the parts of the trajectory that it names, from the same directory. Throws
/// std::runtime_error naming the file and the reason: it cannot be read, is of another version, or is
/// damaged.
Snapshot read_snapshot(const std::string& path);

/// Of which journal a snapshot is, and how far it reaches. Throws as `read_snapshot`, but does not look at
/// the map and the trajectory's parts.
JournalPlace read_snapshot_place(const std::string& path);

/// What a snapshot tells of itself without its map.
struct SnapshotSummary {
  JournalPlace place;
  std::int64_t events = 0;      ///< as in ServedMap
  std::int64_t last_utime = 0;  ///< as in ServedMap
  std::map<std::int32_t, std::int64_t>
      scan_utime;  ///< newest stamp of each session in the newest rows of the trajectory
};

/// Throws as `read_snapshot`, but does not look at the map, nor at older rows.
SnapshotSummary read_snapshot_summary(const std::string& path);

/// Writes the state at a place of a journal into its directory: first the rows beyond those of `earlier`,
/// then the snapshot, each file complete or not at all. Throws std::runtime_error naming the file and the
/// reason.
void write_snapshot(const std::string& directory, const JournalPlace& place, ServedMap& map,
                    const std::vector<TrajectoryPart>& earlier);

/// Whether a file is a snapshot, of whatever version.
bool is_snapshot(const std::string& path);

}  // namespace isthmus
