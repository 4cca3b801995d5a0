#pragma once

#include <functional>
#include <string>

#include "server/engine/record/map_copy.hpp"

namespace isthmus {

/// A robot's pose at one scan, projected by its patch's pose of this map.
struct ProjectedRow {
  const Session& session;
  std::int64_t utime = 0;
  PatchId patch;
  Pose map_from_robot;
  /// The patch is on another island than the session's first patch, as a withdrawn merge may leave it: the
  /// pose is not in the session's frame.
  bool parted = false;
};

/// Calls `visit` with every row of the trajectory in event order. Memory does not grow with their number.
void for_each_row(const MapCopy& map, const std::function<void(const ProjectedRow&)>& visit);

/// The robots of all sessions, by name, each once.
std::vector<std::string> robots_of(const MapCopy& map);

/// The same in the order of their first sessions, which no robot that joins later changes.
std::vector<std::string> robots_as_they_came(const MapCopy& map);

/// The name of a robot as the name of a file: what is not a letter, a digit, '_' or '-' becomes %XX.
std::string file_name_of(const std::string& robot);

/// How many rows are parted from their sessions.
std::size_t count_parted_rows(const MapCopy& map);

/// Writes ROBOT.tum for each robot into a directory: `timestamp tx ty tz qx qy qz qw`, all sessions' rows but
/// those parted.
void write_trajectories(const MapCopy& map, const std::string& directory);

}  // namespace isthmus
