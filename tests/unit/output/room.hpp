#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "server/engine/record/map_copy.hpp"

namespace isthmus::testing {

/// A wall between two points of the map.
struct Wall {
  Eigen::Vector2d from;
  Eigen::Vector2d to;
};

/// The walls of a rectangle.
std::vector<Wall> rectangle(double left, double bottom, double right, double top);

/// A scan of `beams` over a full turn, without noise; +infinity where it meets no wall within range_max_m.
Scan scan_at(const std::vector<Wall>& walls, const Pose& map_from_robot, std::int64_t utime,
             std::size_t beams = 360, double range_max_m = 30);

/// A map of one robot, R1, that made a patch at each of its poses; odometry relations from each to the next.
/// The trajectory has the rows of the patches, a second apart, from utime 1,000,000 on.
MapCopy map_of(const std::vector<Wall>& walls, const std::vector<Pose>& map_from_patches,
               const PatchOptions& options = {});

/// Of a room of 4 m by 3 m, with three patches.
MapCopy room();

/// A relation that measures a pose.
Relation relative_pose(PatchId a, PatchId b, const Pose& a_from_b, const Eigen::Matrix3d& information);

/// A fixed tag on the map, seen from one patch with σ = 0.1 m along its x axis and 0.2 m along y. With no
/// such patch it stands alone.
PatchId add_tag(MapCopy& map, std::int32_t barcode, PatchId seen_from, const Eigen::Vector2d& position);

/// A directory of its own that goes away with it.
class TemporaryDirectory {
 public:
  TemporaryDirectory();
  ~TemporaryDirectory();
  std::string file(const std::string& name) const { return (path_ / name).string(); }
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

std::string content(const std::string& file);
std::vector<std::string> lines(const std::string& file);

}  // namespace isthmus::testing
