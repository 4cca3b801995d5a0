#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "tools/simulate/live/live_robot.hpp"
#include "tools/simulate/live/pilot.hpp"
#include "tools/simulate/run/simulation.hpp"

namespace isthmus {

/// Robots in a simulated building that drive as their pilots say, tick by tick: what they sense on the way,
/// what they touch, and where they truly were. The same for the same arguments and paths.
class LiveTeam {
 public:
  static constexpr double tick_s = 0.05;

  /// A robot and what it knows by itself.
  struct Member {
    Member(const RobotPlan& plan, const Pose& start, std::uint64_t seed, std::int64_t utime)
        : robot(plan, start, seed, utime), pilot(plan.drive, plan.radius_m) {}

    const std::string& name() const { return robot.plan().name; }
    /// Where its odometry had it at the time of a scan of the last minute.
    std::optional<Pose> odom_from_robot_at(std::int64_t utime) const;

    LiveRobot robot;
    Pilot pilot;
    std::deque<std::pair<std::int64_t, Pose>> odometry;
    std::vector<Eigen::Vector2d> trail;  ///< true
    bool touches_wall = false;
    bool tried_again = false;  ///< since it got on last
  };

  /// The scenario's first robots, at true poses.
  LiveTeam(const Scenario& scenario, std::uint64_t seed, const std::vector<Pose>& starts);

  std::size_t size() const { return members_.size(); }
  Member& operator[](std::size_t i) { return *members_[i]; }
  const Member& operator[](std::size_t i) const { return *members_[i]; }
  const RayCaster& caster() const { return caster_; }
  double time_s() const { return tick_ * tick_s; }
  std::int64_t utime() const { return start_utime_ + std::llround(1e6 * time_s()); }

  /// Whoever takes what robots send, in order.
  using Take = std::function<void(decltype(Event::body))>;
  void sense(const Take& take);
  /// All go on by a tick.
  void move();

  const std::vector<RobotTruth>& truth() const { return truth_; }
  double way_m() const;
  std::size_t touched_walls() const { return touched_walls_; }    ///< times that a robot came to touch one
  std::size_t touched_robots() const { return touched_robots_; }  ///< pairs that came to touch

 private:
  void scan(std::size_t i, const Take& take);
  void look(std::size_t i, const Take& take);
  void try_again(Member& member) const;
  void count_touching_robots();

  std::int64_t start_utime_;
  RayCaster caster_;
  std::vector<std::unique_ptr<Member>> members_;
  std::vector<RobotTruth> truth_;
  int tick_ = 0;
  std::size_t touched_walls_ = 0, touched_robots_ = 0;
  std::set<std::pair<std::size_t, std::size_t>> touching_;
};

/// Where the first so many of the scenario's robots start beside one another: where the first one does.
/// Throws std::runtime_error where there are fewer, or no room for them.
std::vector<Pose> starts_side_by_side(const Scenario& scenario, std::size_t robots, double clearance_m);
/// Where the scenario has them. Throws std::runtime_error where there are fewer.
std::vector<Pose> own_starts(const Scenario& scenario, std::size_t robots);

}  // namespace isthmus
