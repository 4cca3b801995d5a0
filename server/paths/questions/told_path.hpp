#pragma once

#include <cstdint>
#include <vector>

#include "server/paths/questions/planner.hpp"

namespace isthmus {

/// What became of a path that a robot was told and drives.
enum class PathChange : std::uint8_t {
  none,          ///< it holds
  moved,         ///< the map has moved what is left of it
  blocked,       ///< the robot does not fit all along it any more
  opened,        ///< there was none, and there is
  shortened,     ///< another way is shorter now by a twentieth
  target_moved,  ///< it does not end at its target any more
  arrived,       ///< the robot is at its end
};

/// A path as it was told, and where its places lay in the plane of their island then.
struct ToldPath {
  static constexpr double moved_m = ground_cell_m;  ///< less is not told
  static constexpr double at_end_m = 0.5;           ///< a robot so near to the end, or an end to its target
  static constexpr double longest_share = 1.05;     ///< of the shortest way

  std::vector<ManifoldPose> poses;  ///< none: there was no way
  std::vector<Eigen::Vector2d> map_points;
};

/// Where the robot is, and which way it would be told now.
struct PathNow {
  ManifoldPose robot;
  Footprint footprint;
  bool over_ground = true;  ///< it is a way over known ground, not a way back as it was driven
  bool drives = true;       ///< the robot goes along it: it may arrive, and the rest alone counts
  Path path;
};

/// Compares a told path with the map as the planner has it. A robot's outline fits along a path where the
/// whole footprint does within its clearance and a cell: what is seen anew moves walls by as much.
PathChange change_of(Planner& planner, const ToldPath& told, const PathNow& now);

}  // namespace isthmus
