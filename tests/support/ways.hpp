#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/engine/map/map.hpp"
#include "tests/support/walls.hpp"

namespace isthmus::testing {

/// The plane of a second island, which is not the world's.
inline const Pose second_from_world{20, 5, 1};

inline Relation odometry_relation(PatchId a, PatchId b, const Pose& a_from_b,
                                  const Eigen::Vector3d& information = {1e4, 1e4, 1e5}) {
  Relation relation;
  relation.a = a;
  relation.b = b;
  relation.kind = RelationKind::odometry;
  relation.measurement = RelativePose{a_from_b, information.asDiagonal()};
  relation.origin = {OriginKind::odometry, {}};
  return relation;
}

/// A robot's way: a patch at each pose of the world, which saw walls of its own, each tied to the one before
/// by odometry, on an island of its own, a second apart. Returns its patches.
inline std::vector<PatchId> add_way(Map& map, const std::vector<Walls>& walls_seen,
                                    const std::vector<Pose>& world_from_patches, const Pose& map_from_world,
                                    const std::string& robot = "R1") {
  std::vector<PatchId> way;
  for (std::size_t i = 0; i < world_from_patches.size(); ++i) {
    const PatchId id = map.manifold().next_id();
    const std::int64_t utime = id.value * 1'000'000;
    map.add(make_patch(id, robot, scan_from(walls_seen[i], world_from_patches[i], utime), laser_of(), {}),
            map_from_world * world_from_patches[i]);
    if (!way.empty()) map.relate(odometry_relation(way.back(), id, map.relative_pose(way.back(), id)));
    way.push_back(id);
  }
  return way;
}

/// The same among walls that all of them saw.
inline std::vector<PatchId> add_way(Map& map, const Walls& walls, const std::vector<Pose>& world_from_patches,
                                    const Pose& map_from_world = {}, const std::string& robot = "R1") {
  return add_way(map, std::vector<Walls>(world_from_patches.size(), walls), world_from_patches,
                 map_from_world, robot);
}

}  // namespace isthmus::testing
