#pragma once

#include "server/exploration/coordinator.hpp"
#include "tests/support/ground_scenes.hpp"

namespace isthmus::testing {

/// A corridor along x from -10 to 10 of 1 m, in which no two robots pass; a niche of 1 m by 1 m opens from it
/// on the left at x = 0. All of it is one island.
struct NarrowCorridor {
  static constexpr Footprint slim{0.2, 0.05};

  Planner planner;
  std::map<std::string, Traveller> team;

  NarrowCorridor() {
    const Walls walls = {{{-10, -0.5}, {10, -0.5}},  {{-10, 0.5}, {-0.6, 0.5}}, {{0.6, 0.5}, {10, 0.5}},
                         {{-0.6, 0.5}, {-0.6, 1.9}}, {{-0.6, 1.9}, {0.6, 1.9}}, {{0.6, 1.9}, {0.6, 0.5}},
                         {{-10, -0.5}, {-10, 0.5}},  {{10, -0.5}, {10, 0.5}}};
    Map map;
    std::vector<Pose> ways;
    for (double x = -9; x <= 9; x += 3) ways.push_back({x, 0, 0});
    ways.push_back({0, 1.2, 0});
    add_round_way(map, walls, ways);
    planner.update(shared_copy(map));
  }

  ManifoldPose at(double x, double y = 0) const {
    return {PatchId{0}, ominus({x, y, 0}, planner.map().poses[0])};
  }
  void add(const std::string& name, double from_x, double to_x, double from_y = 0) {
    Traveller& traveller = team[name];
    traveller = {at(from_x, from_y), slim, {}};
    traveller.path = planner.path({traveller.pose, at(to_x), slim}).poses;
  }
  void add_idle(const std::string& name, double x, double y = 0) { team[name] = {at(x, y), slim, {}}; }
  Eigen::Vector2d end_of(const Clearance& clearance) const {
    return position(planner.project(clearance.path.back()));
  }
};

}  // namespace isthmus::testing
