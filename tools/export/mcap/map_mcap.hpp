#pragma once

#include <functional>
#include <string>

#include "server/engine/input/configuration.hpp"
#include "server/engine/record/map_copy.hpp"

namespace isthmus {

struct McapOptions {
  /// A log or journal whose scans are written too; empty: none.
  std::string log;
  double resolution_m = 0.05;  ///< of grids; coarser where they would have more than 2000² cells
  std::function<void(double)> progress;
};

/// Writes a map as an MCAP file that Foxglove and Lichtblick play: what is the map's is as the finished map
/// has it, from the beginning on.
///
///     /tf            FrameTransforms: island-K in map, where islands lie side by side; robots on their
///     islands,
///                    and their lasers
///     /ROBOT/pose    PoseInFrame, at every scan
///     /ROBOT/scan    LaserScan
///     /island-K/grid Grid
///     /scene         SceneUpdate: patches, tags with barcodes, closures
///     /log           Log: what became of closures, when it was decided
///
/// Stamps are the robots' own, those of /log are event time. Returns how many messages there are. Throws
/// std::runtime_error naming the file and the reason.
std::uint64_t write_mcap(const MapCopy& map, const Configuration& configuration, const std::string& path,
                         const McapOptions& options);

}  // namespace isthmus
