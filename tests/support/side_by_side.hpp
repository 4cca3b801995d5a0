#pragma once

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "server/engine/robot/world.hpp"
#include "server/engine/sightings/evidence.hpp"
#include "tests/support/ways.hpp"

namespace isthmus::testing {

/// Two robots that drive side by side through a room, half a metre and a second from patch to patch:
///
///    R2, barcode 2:   6 --> 7 --> ... 11
///    R1, barcode 1:   0 --> 1 --> ... 5
///
/// from second 10 on. Each is on an island of its own, unless they are joined.
struct SideBySide {
  static constexpr int patches = 6;

  explicit SideBySide(const Walls& walls = furnished_room()) {
    std::vector<Pose> ways[2];
    for (int i = 0; i < patches; ++i)
      for (const int robot : {0, 1}) ways[robot].push_back({-2 + 0.5 * i, robot == 0 ? -1.5 : 0, 0});
    first = add_way(map, walls, ways[0]);
    second = add_way(map, walls, ways[1], second_from_world, "R2");
    enter("R1", 1, first, ways[0]);
    enter("R2", 2, second, ways[1]);
  }

  /// Both on one island; the tie is known with so much information of x, y and yaw.
  void join(const Eigen::Vector3d& information = {1e4, 1e4, 1e5}) {
    map.move_island(second.front(), inverse(second_from_world));
    map.relate(odometry_relation(first.front(), second.front(), {0, 1.5, 0}, information));
  }

  World world(double now_s) { return {map, robots, options, utime(now_s), false}; }

  static std::int64_t utime(double s) { return static_cast<std::int64_t>(1e6 * s); }
  /// Where a robot is at a second, in the world; R2 likewise.
  static Eigen::Vector2d r1_at(double s) { return {-2 + 0.5 * (s - 10), -1.5}; }
  static Eigen::Vector2d r2_at(double s) { return {-2 + 0.5 * (s - 10), 0}; }

  /// What a robot sees at a second of what is at a place in the world.
  static SightingEvent seen(const std::string& robot, double s, std::int32_t barcode,
                            const Eigen::Vector2d& place) {
    const Eigen::Vector2d to = place - (robot == "R1" ? r1_at(s) : r2_at(s));
    return {robot, utime(s), barcode, to.norm(), 0.05, std::atan2(to.y(), to.x()), 0.03};
  }
  static SightingEvent r1_sees_r2(double s) { return seen("R1", s, 2, r2_at(s)); }
  static SightingEvent r2_sees_r1(double s) { return seen("R2", s, 1, r1_at(s)); }

  /// The same on the manifold, by whole seconds; `record`: its place among all sightings.
  Evidence evidence(const SightingEvent& sighting, std::size_t record) const {
    const bool by_first = sighting.robot == "R1";
    Evidence made;
    made.record = record;
    made.sighting = sighting;
    made.receive_utime = sighting.utime;
    made.target = by_first ? "R2" : "R1";
    made.observer = place(by_first, sighting.utime);
    made.target_place = place(!by_first, sighting.utime);
    return made;
  }

  const Pose second_from_world{20, 5, 1};
  Map map;
  std::map<std::string, Robot> robots;
  EngineOptions options;
  std::vector<PatchId> first;   ///< of R1
  std::vector<PatchId> second;  ///< of R2

 private:
  void enter(const std::string& name, std::int32_t barcode, const std::vector<PatchId>& way,
             const std::vector<Pose>& world_from_patches) {
    Robot& robot = robots[name];
    robot.declared = true;
    robot.declaration.robot = name;
    robot.declaration.barcode = barcode;
    for (std::size_t i = 0; i < way.size(); ++i) {
      const std::int64_t at = utime(10.0 + static_cast<double>(i));
      robot.odometry.add(at, world_from_patches[i]);
      robot.history.add({at, 0, {way[i], {}}, Eigen::Matrix3d::Zero(), world_from_patches[i]}, {});
    }
  }
  PastPlace place(bool of_first, std::int64_t at) const {
    const auto i = static_cast<std::size_t>(at / 1'000'000 - 10) % patches;
    return {at, 0, {(of_first ? first : second)[i], {}}, Eigen::Matrix3d::Zero(), {}};
  }
};

}  // namespace isthmus::testing
