#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "patches/scan.hpp"
#include "server/output/grid/grid.hpp"

/// Messages that Foxglove and Lichtblick show (docs.foxglove.dev/docs/sdk/schemas), as JSON. Lengths are in
/// metres, angles in radians; `utime` is in microseconds, and one before 1970 is written as 1970.
namespace isthmus::foxglove {

enum class Kind : std::uint8_t { frame_transforms, pose_in_frame, laser_scan, grid, scene_update, log };

/// A kind's name, and its fields as JSON schema.
struct Schema {
  std::string name;
  std::string text;
};
Schema schema(Kind kind);

struct Transform {
  std::string parent;
  std::string child;
  Pose parent_from_child;
};
std::string frame_transforms(std::int64_t utime, const std::vector<Transform>& transforms);

std::string pose_in_frame(std::int64_t utime, const std::string& frame, const Pose& frame_from_robot);

/// A beam that says nothing, or that nothing came back on, has range 0: JSON has no infinity.
std::string laser_scan(const Scan& scan, const Laser& laser, const std::string& frame);

/// Grids of more cells are too much for viewers.
inline constexpr std::size_t max_grid_cells = 2000 * 2000;
/// Cells are 0 free, 100 occupied, 255 unknown, row by row from the lowest y on.
std::string grid(std::int64_t utime, const OccupancyGrid& cells, const std::string& frame);

enum class Level : std::uint8_t { info = 2, warning = 3 };
std::string log(std::int64_t utime, Level level, const std::string& text);

/// A point of a scene; with a text beside it where that is not empty.
struct Mark {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  std::string text;
  bool operator==(const Mark&) const = default;
};
struct SceneLine {
  Eigen::Vector2d from = Eigen::Vector2d::Zero();
  Eigen::Vector2d to = Eigen::Vector2d::Zero();
  bool operator==(const SceneLine&) const = default;
};
/// What is shown of an island, in its frame.
struct Scene {
  std::string frame;
  std::vector<Mark> patches;
  std::vector<Mark> tags;
  std::vector<SceneLine> closures;
  bool operator==(const Scene&) const = default;
};
/// Shows these, each in place of what was shown in its frame before, and no longer those of `gone` frames.
std::string scene_update(std::int64_t utime, const std::vector<Scene>& scenes,
                         const std::vector<std::string>& gone = {});

}  // namespace isthmus::foxglove
