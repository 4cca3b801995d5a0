#pragma once

#include <cstdint>
#include <set>
#include <vector>

#include "server/feature_maps/merging/free_ground.hpp"
#include "server/features/state/state.hpp"

namespace isthmus {

/// A wall of a map, a and b as of a Feature.
struct MapWall {
  Eigen::Vector2d a;
  Eigen::Vector2d b;
  Eigen::Vector2d along;
  double length_m = 0;
  std::size_t feature = 0;  ///< index in the state

  Eigen::Vector2d across() const { return {along.y(), -along.x()}; }
};

/// What becomes of a wall where another map lies over it.
enum class WallFate : std::uint8_t {
  explained,     ///< it has a twin
  contradicted,  ///< the other map saw through where it would stand
  missed,        ///< the other map saw the ground before it, and no such wall
  beyond         ///< the other map does not know the place
};

/// Of a wall without a twin: contradicted, missed or beyond.
WallFate fate_in(const FreeGround& ground, const MapWall& wall, const MergingOptions& options);

/// What of a map can be laid over another one: its walls, and what it knows to be free.
struct MapSketch {
  std::vector<MapWall> walls;
  FreeGround free;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();  ///< of its walls
  double own_share = 0;                              ///< of walls that stand where it saw through itself
};

/// The longest walls that some of its robots brought, by index, and what these saw free.
MapSketch sketch_of(const FeatureState& state, const std::set<int>& robots,
                    const std::vector<const std::vector<FreeView>*>& views, const MergingOptions& options);

/// The wall of frame b in frame a.
MapWall operator*(const Pose& a_from_b, const MapWall& wall_b);

}  // namespace isthmus
