#pragma once

#include <map>
#include <string>

namespace isthmus {

/// The files of a journal's directory, by the number of the segment that they are or end with.
struct JournalFiles {
  std::map<int, std::string> segments;   ///< journal-000001.lcm, ...
  std::map<int, std::string> snapshots;  ///< snapshot-000001.isthmus, ...: the state after that segment
};

/// Throws std::runtime_error naming the directory where it cannot be read, or holds logs that are no
/// segments.
JournalFiles list_journal(const std::string& directory);

/// Whether a path is a directory that holds segments, and no other logs.
bool is_journal(const std::string& path);

std::string segment_path(const std::string& directory, int segment);
std::string snapshot_path(const std::string& directory, int segment);
/// Of the rows of the trajectory that a segment and those since the snapshot before added.
std::string trajectory_path(const std::string& directory, int segment);

}  // namespace isthmus
