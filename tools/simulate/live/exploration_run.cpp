#include "tools/simulate/live/exploration_run.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "server/paths/questions/relative_pose.hpp"
#include "tools/evaluate/alignment.hpp"
#include "tools/simulate/live/reachable_ground.hpp"
#include "tools/simulate/live/served_team.hpp"
#include "tools/simulate/run/cpu_clock.hpp"
#include "tools/simulate/truth/true_patches.hpp"

namespace isthmus {
namespace {

constexpr double explored_after_s = 20;  // without a goal for anybody: nothing is left

class ExplorationRun {
 public:
  ExplorationRun(const Scenario& scenario, std::uint64_t seed, const ExplorationRunOptions& options,
                 const WatchExploration& watch, const WatchOrders& watch_orders)
      : options_(options),
        watch_(watch),
        watch_orders_(watch_orders),
        served_(scenario, seed,
                options.apart ? own_starts(scenario, options.robots)
                              : starts_side_by_side(scenario, options.robots, options.clearance_m),
                options.clearance_m),
        orders_(served_.robots().size()),
        expedition_(options.expedition),
        ground_(scenario.plan, served_.robots().caster(),
                position(served_.robots()[0].robot.world_from_robot()),
                served_.robots()[0].robot.plan().radius_m + options.clearance_m) {
    score_.reachable_m2 = ground_.area_m2();
  }

  ExplorationScore run() {
    const int plan_ticks = static_cast<int>(options_.plan_period_s / LiveTeam::tick_s);
    const int measure_ticks = static_cast<int>(options_.measure_period_s / LiveTeam::tick_s);
    for (int tick = 0; !is_done(); ++tick) {
      served_.sense();
      if (tick > 0 && tick % plan_ticks == 0) plan();
      if (tick % measure_ticks == 0 && tick > 0) measure();
      served_.robots().move();
    }
    measure();
    score_.end_s = robots().time_s();
    score_.given_up = robots().time_s() >= options_.max_s;
    score_.touched_walls = robots().touched_walls();
    score_.touched_robots = robots().touched_robots();
    score_.goals = expedition_.counts().goals;
    score_.goals_given_up = expedition_.counts().given_up;
    score_.gave_way = expedition_.counts().gave_way;
    score_.islands = served_.islands();
    return score_;
  }

 private:
  bool is_done() const {
    return robots().time_s() - busy_s_ >= explored_after_s || robots().time_s() >= options_.max_s;
  }

  void plan() {
    const double begin_ms = cpu_now_ms();
    served_.update_map();
    if (score_.merged_s == 0 && served_.members().size() == robots().size() && served_.islands() == 1)
      score_.merged_s = robots().time_s();
    const auto orders = expedition_.plan(served_.planner(), served_.members(), robots().time_s());
    for (std::size_t i = 0; i < robots().size(); ++i) {
      const auto found = orders.find(robots()[i].name());
      if (found == orders.end()) continue;  // it goes on with its last one
      const ExplorationOrder& order = orders_[i] = found->second;
      if (order.reason != OrderReason::finished) busy_s_ = robots().time_s();
      served_.obey(i, order);
      if (watch_orders_) tell_order(i);
    }
    score_.plan_cpu_ms = std::max(score_.plan_cpu_ms, cpu_now_ms() - begin_ms);
  }

  void tell_order(std::size_t i) const {
    const LiveTeam::Member& member = robots()[i];
    watch_orders_({robots().time_s(), served_.planner(), member.name(), member.robot.world_from_robot(),
                   served_.answer(i)->pose, orders_[i], member.pilot.stuck_s()});
  }

  const LiveTeam& robots() const { return served_.robots(); }

  /// The world's frame on each island's, from where its patches truly are.
  std::map<IslandId, Pose> islands_from_world() const {
    const MapCopy& map = served_.planner().map();
    const auto truth = true_patches(map, robots().truth());
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
    served_.update_map();
    std::size_t found = 0;
    const auto islands = islands_from_world();
    std::vector<std::pair<Pose, std::shared_ptr<const Roadmap>>> grounds;
    for (const auto& [island, island_from_world] : islands)
      if (auto roadmap = served_.planner().roadmap(island, served_.footprint(0)))
        grounds.emplace_back(island_from_world, std::move(roadmap));
    for (const Eigen::Vector2d& point : ground_.points())
      found += std::any_of(grounds.begin(), grounds.end(), [&](const auto& ground) {
        const auto [first, last] = ground.second->ground().at(cell_of(ground.first * point));
        for (NodeId node = first; node < last; ++node)
          if (!ground.second->ground().layer(node).is_gap) return true;
        return false;
      });
    score_.share = static_cast<double>(found) / static_cast<double>(ground_.points().size());
    score_.way_m = robots().way_m();
    if (score_.found_s == 0 && score_.share >= options_.found_share) {
      score_.found_s = robots().time_s();
      score_.found_way_m = score_.way_m;
    }
    if (!watch_) return;
    ExplorationView view{robots().time_s(), served_.planner(), {}, {}};
    for (const auto& [name, known] : served_.members()) view.team[name].pose = known.pose;
    for (std::size_t i = 0; i < robots().size(); ++i) {
      const std::string& name = robots()[i].name();
      view.trails[name] = robots()[i].trail;
      if (view.team.contains(name)) show_order(orders_[i], view.team[name]);
    }
    watch_(view);
  }

  /// What of an order is on the robot's island: the map may have parted since.
  void show_order(const ExplorationOrder& order, ExploringRobot& robot) const {
    const MapCopy& map = served_.planner().map();
    const auto is_there = [&](const ManifoldPose& pose) {
      return check(map, pose) == Refusal::none &&
             map.graph.island(pose.patch) == map.graph.island(robot.pose.patch);
    };
    if (order.goal && is_there(order.goal->viewpoint)) robot.goal = order.goal->viewpoint;
    if (std::ranges::all_of(order.path, is_there)) robot.way = order.path;
  }

  const ExplorationRunOptions& options_;
  const WatchExploration& watch_;
  const WatchOrders& watch_orders_;
  ServedTeam served_;
  std::vector<ExplorationOrder> orders_;  // by robot
  Expedition expedition_;
  ReachableGround ground_;
  ExplorationScore score_;
  double busy_s_ = 0;  // when somebody had a goal last
};

}  // namespace

ExplorationScore explore(const Scenario& scenario, std::uint64_t seed, const ExplorationRunOptions& options,
                         const WatchExploration& watch, const WatchOrders& watch_orders) {
  return ExplorationRun(scenario, seed, options, watch, watch_orders).run();
}

}  // namespace isthmus
