#pragma once

#include <algorithm>
#include <limits>

#include "server/exploration/coordinator.hpp"
#include "tests/support/ground_scenes.hpp"

namespace isthmus::testing {

/// Corridors of 1 m, in which no two robots pass, and robots that drive there as they are cleared. All of it
/// is one island.
struct NarrowCorridors {
  static constexpr Footprint slim{0.2, 0.05};
  static constexpr double stops_m = 0.45;     ///< so near to another a robot drives no further,
  static constexpr double hesitant_m = 0.42;  ///< or so near where it did not get on
  static constexpr int hesitates = 3;         ///< for so many steps, as pilots of the simulation do
  static constexpr double at_point_m = 0.1;   ///< so near to a point of its path it steers to the next
  static constexpr double arrived_m = 0.5;

  Planner planner;
  std::map<std::string, Traveller> team;

  NarrowCorridors(const Walls& walls, const std::vector<Pose>& stood) {
    Map map;
    add_round_way(map, walls, stood);
    planner.update(shared_copy(map));
  }

  ManifoldPose at(double x, double y = 0) const {
    return {PatchId{0}, ominus({x, y, 0}, planner.map().poses[0])};
  }
  void add(const std::string& name, double from_x, double to_x, double from_y = 0) {
    add_idle(name, from_x, from_y);
    send(name, {to_x, 0});
  }
  void add_idle(const std::string& name, double x, double y = 0) { team[name] = {at(x, y), slim, {}}; }
  void send(const std::string& name, const Eigen::Vector2d& to) {
    Traveller& traveller = team.at(name);
    traveller.path = planner.path({traveller.pose, at(to.x(), to.y()), slim}).poses;
  }
  Eigen::Vector2d end_of(const Clearance& clearance) const {
    return position(planner.project(clearance.path.back()));
  }
  Eigen::Vector2d place(const std::string& name) const {
    return position(planner.project(team.at(name).pose));
  }

  /// Robots drive to their goals, those without one give way; half a metre at a time, as they are cleared.
  /// How near two of them came.
  double drive(Coordinator& coordinator, const std::map<std::string, Eigen::Vector2d>& goals, int steps) {
    double least_m = std::numeric_limits<double>::infinity();
    for (int step = 0; step < steps; ++step) {
      for (auto& [name, traveller] : team) {
        traveller.path.clear();
        const auto goal = goals.find(name);
        if (goal != goals.end()) send(name, goal->second);
      }
      for (const auto& [name, clearance] : coordinator.coordinate(planner, team)) drive_on(name, clearance);
      least_m = std::min(least_m, nearest_m());
    }
    return least_m;
  }

  /// Of any two robots.
  double nearest_m() const {
    double least_m = std::numeric_limits<double>::infinity();
    for (const auto& [a, one] : team)
      for (const auto& [b, other] : team)
        if (a < b) least_m = std::min(least_m, (place(a) - place(b)).norm());
    return least_m;
  }

 private:
  std::map<std::string, int> stuck_;  // for how many steps

  void drive_on(const std::string& name, const Clearance& clearance) {
    const Eigen::Vector2d from = place(name);
    follow(name, clearance);
    int& stuck = stuck_[name];
    stuck = clearance.path.empty() || (place(name) - from).norm() > at_point_m ? 0 : stuck + 1;
  }

  void follow(const std::string& name, const Clearance& clearance) {
    double left_m = 0.5;
    for (const ManifoldPose& next : clearance.path) {
      const Eigen::Vector2d there = position(planner.project(next));
      if ((there - place(name)).norm() < at_point_m && &next != &clearance.path.back()) continue;
      while ((there - place(name)).norm() > 1e-6) {
        const Eigen::Vector2d by = there - place(name);
        const double step_m = std::min({0.1, left_m, by.norm()});
        const Eigen::Vector2d to = place(name) + by.normalized() * step_m;
        if (step_m < 1e-6 || is_taken(name, to)) return;
        team[name].pose = at(to.x(), to.y());
        left_m -= step_m;
      }
    }
  }

  /// Where a robot would come too near to another: it stops by itself.
  bool is_taken(const std::string& name, const Eigen::Vector2d& to) const {
    const auto stuck = stuck_.find(name);
    const double least_m = stuck != stuck_.end() && stuck->second >= hesitates ? hesitant_m : stops_m;
    return std::ranges::any_of(team, [&](const auto& other) {
      if (other.first == name) return false;
      const double apart_m = (place(other.first) - to).norm();
      return apart_m < least_m && apart_m < (place(other.first) - place(name)).norm();
    });
  }
};

/// Along x from -10 to 10; a niche of 1 m by 1 m opens from it on the left at x = 0.
struct NarrowCorridor : NarrowCorridors {
  NarrowCorridor() : NarrowCorridors(walls(), stood()) {}

 private:
  static Walls walls() {
    return {{{-10, -0.5}, {10, -0.5}},  {{-10, 0.5}, {-0.6, 0.5}}, {{0.6, 0.5}, {10, 0.5}},
            {{-0.6, 0.5}, {-0.6, 1.9}}, {{-0.6, 1.9}, {0.6, 1.9}}, {{0.6, 1.9}, {0.6, 0.5}},
            {{-10, -0.5}, {-10, 0.5}},  {{10, -0.5}, {10, 0.5}}};
  }
  static std::vector<Pose> stood() {
    std::vector<Pose> poses;
    for (double x = -9; x <= 9; x += 3) poses.push_back({x, 0, 0});
    poses.push_back({0, 1.2, 0});
    return poses;
  }
};

/// A comb: along x from -10 to 10, and five dead ends on the left, each 4 m deep, at x = -8, -4, 0, 4 and 8.
struct NarrowComb : NarrowCorridors {
  static constexpr double deep_m = 4;
  NarrowComb() : NarrowCorridors(walls(), stood()) {}

 private:
  static Walls walls() {
    Walls walls = {{{-10, -0.5}, {10, -0.5}}, {{-10, -0.5}, {-10, 0.5}}, {{10, -0.5}, {10, 0.5}}};
    double before = -10;
    for (double x = -8; x <= 8; x += 4) {
      walls.push_back({{before, 0.5}, {x - 0.5, 0.5}});
      walls.push_back({{x - 0.5, 0.5}, {x - 0.5, 0.5 + deep_m}});
      walls.push_back({{x - 0.5, 0.5 + deep_m}, {x + 0.5, 0.5 + deep_m}});
      walls.push_back({{x + 0.5, 0.5 + deep_m}, {x + 0.5, 0.5}});
      before = x + 0.5;
    }
    walls.push_back({{before, 0.5}, {10, 0.5}});
    return walls;
  }
  static std::vector<Pose> stood() {
    std::vector<Pose> poses;
    for (double x = -8; x <= 8; x += 4) {
      poses.push_back({x, 0, 0});
      poses.push_back({x, deep_m, 0});
    }
    return poses;
  }
};

}  // namespace isthmus::testing
