#include "tools/simulate/live/home_run.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/paths/questions/driven_ways.hpp"
#include "tools/simulate/live/served_team.hpp"

namespace isthmus {
namespace {

constexpr int plan_ticks = 20;
constexpr double moved_m = 0.3;

/// A robot on its way home.
struct Homing {
  HomeScore score;
  bool done = false;
  Eigen::Vector2d moved_from = Eigen::Vector2d::Zero();
  double moved_s = 0;
  double out_end_m = 0;
  std::size_t out_trail = 0;
};

class HomeRun {
 public:
  HomeRun(const Scenario& scenario, std::uint64_t seed, const HomeRunOptions& options)
      : options_(options),
        starts_(own_starts(scenario, options.robots)),
        served_(scenario, seed, starts_, options.clearance_m),
        homing_(options.robots) {}

  std::vector<HomeScore> run(const WatchHome& watch) {
    explore();
    turn_back();
    for (int tick = 0; !std::ranges::all_of(homing_, &Homing::done); ++tick) {
      served_.sense();
      if (tick % plan_ticks == 0) plan();
      robots().move();
      for (std::size_t i = 0; i < homing_.size(); ++i) look(i);
    }
    std::vector<HomeScore> scores;
    for (Homing& homing : homing_) {
      homing.score.touched_walls = robots().touched_walls() - touched_walls_out_;
      homing.score.touched_robots = robots().touched_robots() - touched_robots_out_;
      scores.push_back(homing.score);
    }
    if (watch) watch(view());
    return scores;
  }

 private:
  LiveTeam& robots() { return served_.robots(); }
  const LiveTeam& robots() const { return served_.robots(); }

  void explore() {
    Expedition expedition;
    for (int tick = 0; robots().time_s() < options_.out_s; ++tick) {
      served_.sense();
      if (tick > 0 && tick % plan_ticks == 0) {
        served_.update_map();
        const auto orders = expedition.plan(served_.planner(), served_.members(), robots().time_s());
        for (std::size_t i = 0; i < robots().size(); ++i) {
          const auto order = orders.find(robots()[i].name());
          if (order != orders.end()) served_.obey(i, order->second);
        }
      }
      robots().move();
    }
  }

  void turn_back() {
    served_.update_map();
    touched_walls_out_ = robots().touched_walls();
    touched_robots_out_ = robots().touched_robots();
    for (std::size_t i = 0; i < homing_.size(); ++i) {
      const LiveTeam::Member& member = robots()[i];
      Homing& homing = homing_[i];
      homing.score.robot = member.name();
      homing.score.out_m = homing.out_end_m = member.robot.driven_m();
      homing.score.islands_out = served_.islands();
      homing.out_trail = member.trail.size();
      homing.moved_s = robots().time_s();
      homing.moved_from = position(member.robot.world_from_robot());
    }
  }

  /// The way back of each from where it is now; who is home stands there, and makes room.
  void plan() {
    served_.update_map();
    ways_.update(served_.planner().map());
    std::map<std::string, Traveller> travellers;
    for (const auto& [name, member] : served_.members()) {
      Traveller& traveller = travellers[name];
      traveller = {member.pose, member.footprint, {}};
      Homing& homing = of(name);
      if (homing.done) continue;
      Path back = ways_.back(served_.planner().map(), served_.planner().near(), served_.planner().zones(),
                             name, 0, member.footprint.radius_m);
      homing.score.refusal = word(back.refusal);
      if (homing.score.way_m == 0) homing.score.way_m = back.length_m;
      traveller.path = std::move(back.poses);
    }
    const auto clearances = coordinator_.coordinate(served_.planner(), travellers);
    for (std::size_t i = 0; i < homing_.size(); ++i) {
      const auto clearance = clearances.find(robots()[i].name());
      if (clearance == clearances.end()) continue;
      if (clearance->second.leave != Leave::go) homing_[i].moved_s = robots().time_s();
      served_.follow(i, clearance->second.path, {});
    }
  }

  Homing& of(const std::string& robot) {
    return *std::ranges::find_if(homing_, [&](const Homing& one) { return one.score.robot == robot; });
  }

  /// Whether it is home, or lost.
  void look(std::size_t i) {
    Homing& homing = homing_[i];
    if (homing.done) return;
    const LiveRobot& robot = robots()[i].robot;
    const Eigen::Vector2d here = position(robot.world_from_robot());
    if ((here - homing.moved_from).norm() > moved_m) {
      homing.moved_from = here;
      homing.moved_s = robots().time_s();
    }
    homing.score.end_m = (here - position(starts_[i])).norm();
    homing.score.home = homing.score.end_m <= options_.home_m;
    homing.done = homing.score.home || robots().time_s() - homing.moved_s >= options_.stopped_s ||
                  robots().time_s() >= 10 * options_.out_s + 600;
    if (!homing.done) return;
    homing.score.driven_m = robot.driven_m() - homing.out_end_m;
    homing.score.time_s = robots().time_s() - options_.out_s;
    robots()[i].pilot.halt();
  }

  HomeView view() const {
    HomeView view;
    for (std::size_t i = 0; i < homing_.size(); ++i) {
      const std::vector<Eigen::Vector2d>& trail = robots()[i].trail;
      const auto turn = trail.begin() + static_cast<std::ptrdiff_t>(homing_[i].out_trail);
      view.names.push_back(robots()[i].name());
      view.starts.push_back(starts_[i]);
      view.ends.push_back(robots()[i].robot.world_from_robot());
      view.out.emplace_back(trail.begin(), turn);
      view.home.emplace_back(turn, trail.end());
    }
    return view;
  }

  const HomeRunOptions& options_;
  std::vector<Pose> starts_;
  ServedTeam served_;
  std::vector<Homing> homing_;  // by robot
  DrivenWays ways_;
  Coordinator coordinator_;
  std::size_t touched_walls_out_ = 0, touched_robots_out_ = 0;
};

}  // namespace

std::vector<HomeScore> come_home(const Scenario& scenario, std::uint64_t seed, const HomeRunOptions& options,
                                 const WatchHome& watch) {
  return HomeRun(scenario, seed, options).run(watch);
}

}  // namespace isthmus
