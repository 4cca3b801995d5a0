#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "patches/pose.hpp"

namespace isthmus {

struct StampedPose {
  std::int64_t utime = 0;
  Pose map_from_robot;
};

/// Poses by nearest stamp.
class Trajectory {
 public:
  /// Rows in any order; of rows with the same stamp the first counts.
  explicit Trajectory(std::vector<StampedPose> rows);

  /// The row nearest in time, the earlier one where two are equally near; nothing where it is farther than
  /// `within_us`.
  std::optional<StampedPose> nearest(std::int64_t utime, std::int64_t within_us) const;

  const std::vector<StampedPose>& rows() const { return rows_; }  ///< by stamp

 private:
  std::vector<StampedPose> rows_;
};

/// Reads `timestamp tx ty tz qx qy qz qw` lines (`#` comments). Throws FileError naming file and line.
Trajectory read_tum(const std::string& file);

/// Every ROBOT.tum of a directory, by upper-case robot. A directory without any is an error.
std::map<std::string, Trajectory> read_trajectories(const std::string& directory);

/// Where a robot was, and on which island's plane.
struct PlacedPose {
  int island = 0;
  std::int64_t utime = 0;
  Pose map_from_robot;
};

/// The trajectories of an output directory, with the islands that its robots.csv gives to each robot's
/// sessions. Without a robots.csv all is one island.
class TeamTrajectories {
 public:
  /// Reads DIR/trajectories/*.tum and DIR/robots.csv. Throws FileError; a directory without trajectories is
  /// an error.
  explicit TeamTrajectories(const std::string& directory);

  /// By nearest stamp within 0.1 s; `robot` in upper case.
  std::optional<PlacedPose> pose(const std::string& robot, std::int64_t utime) const;

  const std::map<std::string, Trajectory>& trajectories() const { return trajectories_; }
  /// In the order in which they came, which is that of their colours on pictures of the map; those of whom
  /// robots.csv says nothing come last.
  std::vector<std::string> robots() const;

 private:
  struct Session {
    int island = 0;
    std::int64_t from_utime = 0;
    std::int64_t to_utime = 0;
  };
  void read_sessions(const std::string& file);

  std::map<std::string, Trajectory> trajectories_;  ///< by upper-case robot
  std::map<std::string, std::vector<Session>> sessions_;
  std::vector<std::string> as_they_came_;
  bool has_sessions_ = false;
};

}  // namespace isthmus
