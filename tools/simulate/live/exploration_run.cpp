#include "tools/simulate/live/exploration_run.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <deque>
#include <memory>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include "server/engine/engine.hpp"
#include "server/paths/relative_pose.hpp"
#include "tools/evaluate/alignment.hpp"
#include "tools/simulate/live/live_robot.hpp"
#include "tools/simulate/live/pilot.hpp"
#include "tools/simulate/live/reachable_ground.hpp"
#include "tools/simulate/truth/true_patches.hpp"

namespace isthmus {
namespace {

constexpr double tick_s = 0.05;
constexpr int scan_ticks = 4;
/// Robots have seen one another before they scan, so that none is a wall on the others' first patches.
constexpr int first_scan_tick = 40;
constexpr int control_ticks = 2;
constexpr int look_ticks = 10;
constexpr int introduction_ticks = 100;
constexpr int idle_ticks = 10;  // a robot that arrived need not wait longer
constexpr double trail_m = 0.3;
/// A robot that does not get on makes way for another that is so near, and gives its goal up after longer.
constexpr double in_the_way_m = 1.5;
constexpr double make_way_s = 6;
constexpr double give_up_s = 15;
constexpr double back_off_m = 2.5;
constexpr double try_again_m = 0.6;
constexpr double back_off_stand_s = 3;
constexpr double start_room_m = 0.15;
constexpr int idle_rounds = 5;  // without a goal for anybody: nothing is left

double cpu_now_ms() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// A robot, what it does by itself, and what the server knows of it.
struct Member {
  Member(const RobotPlan& plan, const Pose& start, std::uint64_t seed, std::int64_t utime)
      : robot(plan, start, seed, utime), pilot(plan.drive, plan.radius_m) {}

  LiveRobot robot;
  Pilot pilot;
  std::deque<std::pair<std::int64_t, Pose>> odometry;  // lately
  std::optional<RobotPose> answer;                     // the newest
  std::optional<ExplorationGoal> goal;
  std::vector<ManifoldPose> given_up;
  std::vector<ManifoldPose> visited;  // goals that it came to
  bool just_visited = false;          // the last of them is no goal now
  std::vector<Eigen::Vector2d> trail;
  bool touches_wall = false;
  bool tried_again = false;  // to come to its goal
};

class ExplorationRun {
 public:
  ExplorationRun(const Scenario& scenario, std::uint64_t seed, const ExplorationRunOptions& options,
                 const WatchExploration& watch)
      : scenario_(scenario), options_(options), watch_(watch), caster_(scenario.plan) {
    if (scenario.robots.size() < options.robots) throw std::runtime_error("the scenario has fewer robots");
    const RobotPlan& first = scenario.robots.front();
    const auto starts = starts_beside(caster_, position(first.start), options.robots,
                                      first.radius_m + options.clearance_m + start_room_m);
    for (std::size_t i = 0; i < options.robots; ++i) {
      RobotPlan plan = scenario.robots[i];
      const Pose start{starts[i].x(), starts[i].y(), first.start.yaw};
      team_.push_back(std::make_unique<Member>(plan, start, seed, scenario.start_utime));
      truth_.push_back({plan.name, {}});
    }
    ground_ = std::make_unique<ReachableGround>(scenario.plan, caster_, starts.front(),
                                                first.radius_m + options.clearance_m);
    score_.reachable_m2 = ground_->area_m2();
  }

  ExplorationScore run() {
    const int plan_ticks = static_cast<int>(options_.plan_period_s / tick_s);
    const int measure_ticks = static_cast<int>(options_.measure_period_s / tick_s);
    for (int tick = 0; !is_done(); ++tick) {
      time_s_ = tick * tick_s;
      sense(tick);
      if (tick > 0 && (tick % plan_ticks == 0 || (tick % idle_ticks == 0 && somebody_arrived()))) plan();
      if (tick % control_ticks == 0)
        for (const auto& member : team_) control(*member);
      for (std::size_t i = 0; i < team_.size(); ++i) move(i);
      count_touching_robots();
      if (tick % measure_ticks == 0 && tick > 0) measure();
    }
    measure();
    score_.end_s = time_s_;
    score_.given_up = time_s_ >= options_.max_s;
    std::set<IslandId> islands;
    for (const auto& member : team_)
      if (member->answer) islands.insert(planner_.map().graph.island(member->answer->pose.patch));
    score_.islands = islands.size();
    return score_;
  }

 private:
  bool is_done() const { return idle_rounds_ >= idle_rounds || time_s_ >= options_.max_s; }

  std::int64_t utime() const { return scenario_.start_utime + std::llround(1e6 * time_s_); }

  bool somebody_arrived() const {
    return std::any_of(team_.begin(), team_.end(),
                       [](const auto& member) { return member->goal && member->pilot.has_arrived(); });
  }

  void handle(decltype(Event::body) body) {
    for (const RobotPose& pose : engine_.handle({utime(), std::move(body)}).poses)
      for (const auto& member : team_)
        if (member->robot.plan().name == pose.robot) member->answer = pose;
  }

  void sense(int tick) {
    for (std::size_t i = 0; i < team_.size(); ++i) {
      Member& member = *team_[i];
      const bool speaks = (tick + static_cast<int>(i)) % introduction_ticks == 0 || tick == 0;
      if (speaks) handle(member.robot.introduction(time_s_));
      handle(member.robot.odometry(time_s_));
      member.odometry.emplace_back(utime(), member.robot.odom_from_robot());
      if (member.odometry.size() > 200) member.odometry.pop_front();
      member.pilot.note_odometry(member.robot.odom_from_robot(), time_s_);
      if (tick >= first_scan_tick && (tick + static_cast<int>(i)) % scan_ticks == 0) scan(i);
      if ((tick + static_cast<int>(i)) % look_ticks == 0) look(i);
    }
  }

  void scan(std::size_t i) {
    Member& member = *team_[i];
    std::vector<Body> bodies;
    for (std::size_t other = 0; other < team_.size(); ++other)
      if (other != i)
        bodies.push_back(
            {position(team_[other]->robot.world_from_robot()), team_[other]->robot.plan().radius_m});
    ScanEvent event = member.robot.scan(time_s_, caster_, bodies);
    truth_[i].poses.push_back({event.scan.utime, 0, member.robot.world_from_robot()});
    member.pilot.note_scan(event.scan, declared_laser(member.robot.plan().laser));
    handle(std::move(event));
    localise(member);
  }

  void look(std::size_t i) {
    for (std::size_t other = 0; other < team_.size(); ++other) {
      if (other == i) continue;
      const LiveRobot& target = team_[other]->robot;
      if (auto seen = team_[i]->robot.look(time_s_, caster_, position(target.world_from_robot()),
                                           target.plan().barcode))
        handle(*seen);
    }
  }

  /// Where the frame of the planner's map lies in that of the robot's odometry.
  void localise(Member& member) {
    if (!member.answer || check(planner_.map(), member.answer->pose) != Refusal::none) return;
    const auto then = std::find_if(member.odometry.begin(), member.odometry.end(),
                                   [&](const auto& row) { return row.first == member.answer->utime; });
    if (then != member.odometry.end())
      member.pilot.localise(then->second * inverse(planner_.project(member.answer->pose)));
  }

  std::map<std::string, Explorer> explorers() const {
    std::map<std::string, Explorer> explorers;
    for (const auto& member : team_) {
      if (!member->answer || check(planner_.map(), member->answer->pose) != Refusal::none) continue;
      Explorer& explorer = explorers[member->robot.plan().name];
      explorer.pose = member->answer->pose;
      explorer.footprint = footprint(*member);
      if (member->goal) explorer.goal = member->goal->viewpoint;
      explorer.given_up = member->given_up;
      if (member->just_visited) explorer.given_up.push_back(member->visited.back());
    }
    return explorers;
  }

  Footprint footprint(const Member& member) const {
    return {member.robot.plan().radius_m, options_.clearance_m};
  }

  void plan() {
    const double begin_ms = cpu_now_ms();
    planner_.update(std::make_shared<const MapCopy>(engine_.copy()));
    for (const auto& member : team_) {
      localise(*member);
      if (member->goal && member->pilot.has_arrived()) visit(*member);
    }
    const auto goals = share_frontiers(planner_, explorers(), options_.exploration);
    bool idle = true;
    for (const auto& member : team_) {
      const auto found = goals.find(member->robot.plan().name);
      if (member->pilot.is_backing_off()) idle = false;
      if (found == goals.end() || member->pilot.is_backing_off()) {
        if (found == goals.end() && !member->pilot.is_backing_off()) {
          member->goal.reset();
          member->pilot.halt();
          member->just_visited = false;
        }
        continue;
      }
      idle = false;
      set_out(*member, found->second);
    }
    idle_rounds_ = idle ? idle_rounds_ + 1 : 0;
    score_.plan_cpu_ms = std::max(score_.plan_cpu_ms, cpu_now_ms() - begin_ms);
  }

  void set_out(Member& member, const ExplorationGoal& goal) {
    if (!is_same(member.goal, goal)) {
      ++score_.goals;
      member.tried_again = false;
    }
    member.goal = goal;
    const Path path = planner_.path({member.answer->pose, goal.viewpoint, footprint(member)});
    if (path.refusal != Refusal::none) return give_up(member);
    std::vector<Eigen::Vector2d> points;
    for (const ManifoldPose& pose : path.poses) points.push_back(position(planner_.project(pose)));
    member.pilot.follow(std::move(points), planner_.project(goal.viewpoint).yaw);
  }

  bool is_same(const std::optional<ExplorationGoal>& before, const ExplorationGoal& goal) const {
    return before && check(planner_.map(), before->viewpoint) == Refusal::none &&
           (position(planner_.project(before->viewpoint)) - position(planner_.project(goal.viewpoint)))
                   .norm() <= options_.exploration.same_goal_m;
  }

  /// What a robot saw nothing new at twice is no goal again.
  void visit(Member& member) {
    const ManifoldPose goal = member.goal->viewpoint;
    const bool again =
        std::any_of(member.visited.begin(), member.visited.end(), [&](const ManifoldPose& one) {
          return (position(planner_.project(one)) - position(planner_.project(goal))).norm() <=
                 options_.exploration.given_up_m;
        });
    if (again) member.given_up.push_back(goal);
    member.visited.push_back(goal);
    member.just_visited = true;
    member.goal.reset();
    member.pilot.halt();
  }

  void give_up(Member& member) {
    if (!member.goal) return;
    ++score_.goals_given_up;
    member.given_up.push_back(member.goal->viewpoint);
    member.goal.reset();
    member.pilot.halt();
  }

  void control(Member& member) {
    if (member.pilot.is_backing_off() || member.pilot.stuck_s() < make_way_s) return;
    if (member.pilot.stuck_s() >= give_up_s) return give_up(member);
    for (const auto& other : team_) {
      if (other.get() == &member) break;  // the first of a team makes way for nobody
      const double apart_m =
          (position(other->robot.world_from_robot()) - position(member.robot.world_from_robot())).norm();
      if (apart_m > in_the_way_m || other->pilot.is_backing_off()) continue;
      ++score_.back_offs;
      return member.pilot.back_off(back_off_m, back_off_stand_s);
    }
    if (!std::exchange(member.tried_again, true)) member.pilot.back_off(try_again_m, 0);
  }

  void move(std::size_t i) {
    Member& member = *team_[i];
    const bool free = member.robot.move(member.pilot.drive(), tick_s, caster_);
    score_.touched_walls += !free && !member.touches_wall;
    member.touches_wall = !free;
    const Eigen::Vector2d here = position(member.robot.world_from_robot());
    if (member.trail.empty() || (member.trail.back() - here).norm() >= trail_m) member.trail.push_back(here);
  }

  void count_touching_robots() {
    std::set<std::pair<std::size_t, std::size_t>> touching;
    for (std::size_t a = 0; a < team_.size(); ++a)
      for (std::size_t b = a + 1; b < team_.size(); ++b) {
        const double apart_m =
            (position(team_[a]->robot.world_from_robot()) - position(team_[b]->robot.world_from_robot()))
                .norm();
        if (apart_m < team_[a]->robot.plan().radius_m + team_[b]->robot.plan().radius_m)
          touching.emplace(a, b);
      }
    for (const auto& pair : touching) score_.touched_robots += !touching_.contains(pair);
    touching_ = std::move(touching);
  }

  double way_m() const {
    double way = 0;
    for (const auto& member : team_) way += member->robot.driven_m();
    return way;
  }

  /// The world's frame on each island's, from where its patches truly are.
  std::map<IslandId, Pose> islands_from_world() const {
    const MapCopy& map = planner_.map();
    const auto truth = true_patches(map, truth_);
    std::map<IslandId, std::vector<PosePair>> pairs;
    for (std::size_t i = 0; i < truth.size(); ++i)
      if (truth[i])
        pairs[map.graph.island(PatchId{static_cast<std::int32_t>(i)})].push_back(
            {truth[i]->world_from_patch, map.poses[i]});
    std::map<IslandId, Pose> found;
    for (const auto& [island, of_island] : pairs)
      found[island] = of_island.size() > 1
                          ? inverse(align(of_island))
                          : of_island[0].map_from_robot * inverse(of_island[0].truth_from_robot);
    return found;
  }

  void measure() {
    planner_.update(std::make_shared<const MapCopy>(engine_.copy()));
    for (const auto& member : team_) localise(*member);
    std::size_t found = 0;
    const auto islands = islands_from_world();
    std::vector<std::pair<Pose, std::shared_ptr<const Roadmap>>> grounds;
    for (const auto& [island, island_from_world] : islands)
      if (auto roadmap = planner_.roadmap(island, footprint(*team_.front())))
        grounds.emplace_back(island_from_world, std::move(roadmap));
    for (const Eigen::Vector2d& point : ground_->points())
      found += std::any_of(grounds.begin(), grounds.end(), [&](const auto& ground) {
        const auto [first, last] = ground.second->ground().at(cell_of(ground.first * point));
        return first != last;
      });
    score_.share = static_cast<double>(found) / static_cast<double>(ground_->points().size());
    score_.way_m = way_m();
    if (score_.found_s == 0 && score_.share >= options_.found_share) {
      score_.found_s = time_s_;
      score_.found_way_m = score_.way_m;
    }
    if (!watch_) return;
    ExplorationView view{time_s_, planner_, explorers(), {}};
    for (const auto& member : team_) view.trails[member->robot.plan().name] = member->trail;
    watch_(view);
  }

  const Scenario& scenario_;
  const ExplorationRunOptions& options_;
  const WatchExploration& watch_;
  RayCaster caster_;
  Engine engine_;
  Planner planner_;
  std::vector<std::unique_ptr<Member>> team_;
  std::vector<RobotTruth> truth_;
  std::unique_ptr<ReachableGround> ground_;
  ExplorationScore score_;
  double time_s_ = 0;
  int idle_rounds_ = 0;
  std::set<std::pair<std::size_t, std::size_t>> touching_;
};

}  // namespace

ExplorationScore explore(const Scenario& scenario, std::uint64_t seed, const ExplorationRunOptions& options,
                         const WatchExploration& watch) {
  return ExplorationRun(scenario, seed, options, watch).run();
}

}  // namespace isthmus
