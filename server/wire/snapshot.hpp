#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/engine/engine.hpp"
#include "server/wire/robot_monitor.hpp"

namespace isthmus {

/// What the events of a journal made, up to the end of a segment.
struct ServedMap {
  Engine engine;
  RobotMonitor monitor;
  std::int64_t events = 0;      ///< of the journal, those too damaged to be read included
  std::int64_t last_utime = 0;  ///< receive time of the last one; 0: none
};

/// A part of the trajectory's rows, in a file of its own: rows never change, so that no snapshot need write
/// those again that were there before it.
struct TrajectoryPart {
  std::int32_t segment = 0;  ///< the file's number
  std::uint64_t rows = 0;

  auto members() { return std::tie(segment, rows); }
};

/// A snapshot that was read.
struct Snapshot {
  ServedMap map;
  std::vector<TrajectoryPart> trajectory;  ///< in order
};

/// Reads a snapshot and the parts of the trajectory that it names, from the same directory. Throws
/// std::runtime_error naming the file and the reason: it cannot be read, is of another version, or is
/// damaged.
Snapshot read_snapshot(const std::string& path);

/// Writes the state after a segment into the journal's directory: first the rows beyond those of `earlier`,
/// then the snapshot, each file complete or not at all. Throws std::runtime_error naming the file and the
/// reason.
void write_snapshot(const std::string& directory, int segment, ServedMap& map,
                    const std::vector<TrajectoryPart>& earlier);

/// Whether a file is a snapshot, of whatever version.
bool is_snapshot(const std::string& path);

}  // namespace isthmus
