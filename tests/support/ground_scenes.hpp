#pragma once

#include <functional>
#include <memory>
#include <numbers>
#include <vector>

#include "server/engine/record/map_copy.hpp"
#include "server/paths/ground/island_surface.hpp"
#include "server/paths/roads/roadmap.hpp"
#include "tests/support/ways.hpp"

namespace isthmus::testing {

/// Of a small robot.
inline constexpr Footprint slim{0.2, 0.1};

inline MapCopy copy_of(const Map& map) {
  MapCopy copy;
  copy.patches.assign(map.manifold().patches().begin(), map.manifold().patches().end());
  copy.poses.assign(map.manifold().poses().begin(), map.manifold().poses().end());
  copy.graph = map.graph();
  return copy;
}

inline std::shared_ptr<const MapCopy> shared_copy(const Map& map) {
  return std::make_shared<const MapCopy>(copy_of(map));
}

/// A patch that saw all around it, as far as `range_m`.
inline PatchPtr round_patch(const Walls& walls, PatchId id, const Pose& world_from_robot,
                            double range_m = 20) {
  Scan scan;
  scan.utime = 1'000'000 * (id.value + 1);
  constexpr int beams = 720;
  scan.bearing0_rad = -std::numbers::pi;
  scan.bearing_step_rad = 2 * std::numbers::pi / beams;
  for (int i = 0; i < beams; ++i) {
    const double bearing = world_from_robot.yaw + scan.bearing0_rad + i * scan.bearing_step_rad;
    const double range = range_to(walls, position(world_from_robot), bearing);
    scan.ranges_m.push_back(static_cast<float>(std::min(range, range_m)));
  }
  PatchOptions options;
  options.free_space.no_return_range_m = range_m;
  return make_patch(id, "R1", scan, laser_of(range_m), options);
}

/// Patches of one robot, each tied to the one before.
inline void add_round_way(Map& map, const Walls& walls, const std::vector<Pose>& world_from_patches) {
  const PatchId first = map.manifold().next_id();
  for (const Pose& pose : world_from_patches) {
    const PatchId id = map.manifold().next_id();
    map.add(round_patch(walls, id, pose), pose);
    if (id == first) continue;
    const PatchId before{id.value - 1};
    map.relate(odometry_relation(before, id, map.relative_pose(before, id)));
  }
}

/// A corridor 2 m wide that bends round to the left, mapped along its middle once and a half round: the
/// second lap lies on the first. Laps are `lap_patches` patches, a metre apart.
struct Spiral {
  static constexpr int lap_patches = 80;

  Map map;
  Spiral() {
    const double radius_m = lap_patches / (2 * std::numbers::pi);
    for (int i = 0; i < lap_patches * 3 / 2; ++i) {
      const PatchId id{i};
      const double angle = 2 * std::numbers::pi * i / lap_patches;
      map.add(round_patch(corridor(), id, {}, 2.5),
              {radius_m * std::sin(angle), radius_m * (1 - std::cos(angle)), angle});
      if (i > 0) map.relate(odometry_relation(PatchId{i - 1}, id, map.relative_pose(PatchId{i - 1}, id)));
    }
  }
  /// Joins a patch of the second lap to that of the first which it lies on.
  void close(int patch) {
    const PatchId a{patch}, b{patch + lap_patches};
    map.relate(odometry_relation(a, b, map.relative_pose(a, b)));
  }
};

inline std::shared_ptr<const Ground> ground_of(const std::shared_ptr<const GroundTile>& tile,
                                               const std::shared_ptr<const NearPatches>& near) {
  IslandSurface surface;
  surface.update({{place_of(*tile), tile}}, *near);
  return std::make_shared<const Ground>(surface.surfaces(), near);
}

enum class Seen { nothing, open, occupied };

/// A tile of one patch from a cell on, `at` saying what each cell is.
inline GroundTile tile_of(const Cell& low, const std::function<Seen(int x, int y)>& at) {
  GroundTile tile{low, {0}, {}};
  for (int y = 0; y < ground_tile_cells; ++y) {
    for (int x = 0; x < ground_tile_cells; ++x) {
      const Seen seen = at(low.x + x, low.y + y);
      if (seen != Seen::nothing) tile.layers.push_back({PatchId{0}, seen == Seen::occupied, false});
      tile.first.push_back(static_cast<std::uint32_t>(tile.layers.size()));
    }
  }
  return tile;
}

/// A ground of one tile from (0, 0) on, of which nothing is seen from `size` cells on.
inline std::shared_ptr<const Ground> ground_of(int size, const std::function<Seen(int x, int y)>& at) {
  const GroundTile tile =
      tile_of({0, 0}, [&](int x, int y) { return x < size && y < size ? at(x, y) : Seen::nothing; });
  return ground_of(std::make_shared<const GroundTile>(tile), std::make_shared<const NearPatches>());
}

inline NodeId node_at(const Ground& ground, int x, int y) { return ground.at({x, y}).first; }

}  // namespace isthmus::testing
