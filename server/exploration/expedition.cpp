#include "server/exploration/expedition.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "server/exploration/meeting_worth.hpp"
#include "server/paths/questions/relative_pose.hpp"

namespace isthmus {
namespace {

/// In the planner's map; infinity where one of them is on no patch of it, or on another island.
double apart_m(const Planner& planner, const ManifoldPose& a, const ManifoldPose& b) {
  const MapCopy& map = planner.map();
  if (check(map, a) != Refusal::none || check(map, b) != Refusal::none ||
      map.graph.island(a.patch) != map.graph.island(b.patch))
    return std::numeric_limits<double>::infinity();
  return (position(planner.project(a)) - position(planner.project(b))).norm();
}

}  // namespace

std::map<std::string, ExplorationOrder> Expedition::plan(Planner& planner,
                                                         const std::map<std::string, ExpeditionMember>& team,
                                                         double time_s) {
  std::map<std::string, ExpeditionMember> known;
  for (const auto& [name, member] : team)
    if (check(planner.map(), member.pose) == Refusal::none) known.emplace(name, member);
  for (const auto& [name, member] : known) look(planner, name, member, time_s);
  look_after_meeting(planner, known);
  share(planner, known, time_s);
  arrange_meeting(planner, known, time_s);
  std::map<std::string, ExplorationOrder> orders;
  for (auto& [name, clearance] : coordinator_.coordinate(planner, travellers(planner, known)))
    orders[name] = order(name, std::move(clearance), time_s);
  return orders;
}

/// Whether it has come to its goal, or does not get on.
void Expedition::look(const Planner& planner, const std::string& name, const ExpeditionMember& member,
                      double time_s) {
  State& state = states_[name];
  if (!state.first) state.first = member.pose;
  std::erase_if(state.deferred, [&](const auto& one) { return one.first < time_s; });
  const bool moved = !state.moved_from || apart_m(planner, *state.moved_from, member.pose) > options_.moved_m;
  if (moved || !state.goal || state.leave != Leave::go) {
    state.moved_from = member.pose;
    state.moved_s = time_s;
  }
  if (!state.goal || state.leave == Leave::go) state.free_s = time_s;
  if (!state.goal) return;
  if (check(planner.map(), state.goal->viewpoint) != Refusal::none) return give_up(state);
  if (state.meeting) return look_at_meeting(planner, state, member.pose, time_s);
  const Pose at = planner.project(member.pose), goal = planner.project(state.goal->viewpoint);
  if ((position(at) - position(goal)).norm() <= options_.arrival_m &&
      std::abs(wrap_angle(at.yaw - goal.yaw)) <= options_.arrival_rad)
    return visit(planner, state);
  if (time_s - state.moved_s >= options_.give_up_s) return give_up(state);
  if (time_s - state.free_s < options_.defer_s) return;
  state.deferred.emplace_back(time_s + options_.defer_s, state.goal->viewpoint);
  state.free_s = time_s;
}

/// A robot that waits there for the other does get on.
void Expedition::look_at_meeting(const Planner& planner, State& state, const ManifoldPose& pose,
                                 double time_s) {
  if (apart_m(planner, pose, state.goal->viewpoint) > options_.arrival_m)
    state.met_s = time_s;
  else
    state.moved_s = time_s;
  const bool is_in_vain =
      time_s - state.met_s >= options_.meet_s || time_s - state.moved_s >= options_.give_up_s;
  if (is_in_vain) give_up(state);
}

bool Expedition::can_meet(const Planner& planner, const std::map<std::string, ExpeditionMember>& team,
                          const MeetingRecord& meeting) const {
  if (missed_.contains(meeting.closure)) return false;
  const auto a = team.find(meeting.a.robot), b = team.find(meeting.b.robot);
  if (a == team.end() || b == team.end()) return false;
  const RelationGraph& graph = planner.map().graph;
  return graph.island(a->second.pose.patch) != graph.island(b->second.pose.patch);
}

/// Keeps to a meeting while the map has it, both robots are on their way or there, and on two islands.
void Expedition::look_after_meeting(const Planner& planner,
                                    const std::map<std::string, ExpeditionMember>& team) {
  if (!meeting_) return;
  const bool both_go = states_.at(meeting_->a.robot).meeting && states_.at(meeting_->b.robot).meeting;
  if (!both_go) missed_.insert(meeting_->closure);
  const auto& offered = planner.map().meeting;
  if (!offered || offered->closure != meeting_->closure || !can_meet(planner, team, *meeting_)) end_meeting();
}

void Expedition::arrange_meeting(Planner& planner, const std::map<std::string, ExpeditionMember>& team,
                                 double time_s) {
  const auto& offered = planner.map().meeting;
  if (meeting_ || !offered || !can_meet(planner, team, *offered)) return;
  const auto explorer = [&](const MeetingPlace& place) {
    const ExpeditionMember& member = team.at(place.robot);
    return Explorer{member.pose, member.footprint, std::nullopt, {}};
  };
  const auto has_work = [&](const MeetingPlace& place) { return states_.at(place.robot).goal.has_value(); };
  const MeetingWorth worth =
      worth_of_meeting(planner, *offered, explorer(offered->a), has_work(offered->a), explorer(offered->b),
                       has_work(offered->b), options_.exploration);
  if (worth.saved_m <= worth.cost_m) return;
  meeting_ = offered;
  ++counts_.meetings;
  send_to_meeting(planner, offered->a, time_s);
  send_to_meeting(planner, offered->b, time_s);
}

void Expedition::send_to_meeting(const Planner& planner, const MeetingPlace& place, double time_s) {
  State& state = states_.at(place.robot);
  state.goal.reset();
  set_goal(planner, state, ExplorationGoal{place.pose, 0, 0, 0}, time_s);
  state.met_s = time_s;
  state.meeting = true;
}

void Expedition::end_meeting() {
  for (const MeetingPlace* place : {&meeting_->a, &meeting_->b}) {
    State& state = states_.at(place->robot);
    if (std::exchange(state.meeting, false)) state.goal.reset();
  }
  meeting_.reset();
}

/// What the team saw nothing new at twice is no goal again: what a robot sees there, others see as well.
void Expedition::visit(const Planner& planner, State& state) {
  const ManifoldPose goal = state.goal->viewpoint;
  if (std::exchange(state.turning, false)) return state.goal.reset();
  if (std::ranges::any_of(visited_, [&](const ManifoldPose& one) {
        return apart_m(planner, one, goal) <= options_.exploration.given_up_m;
      }))
    looked_at_.push_back(goal);
  visited_.push_back(goal);
  state.just_visited = goal;
  state.goal.reset();
}

void Expedition::give_up(State& state) {
  ++counts_.given_up;
  const bool was_frontier = !std::exchange(state.turning, false) && !std::exchange(state.meeting, false);
  if (was_frontier) state.given_up.push_back(state.goal->viewpoint);
  state.goal.reset();
}

void Expedition::share(Planner& planner, const std::map<std::string, ExpeditionMember>& team, double time_s) {
  const bool somebody_idle =
      std::ranges::any_of(team, [&](const auto& member) { return !states_.at(member.first).goal; });
  if (shared_s_ && !somebody_idle && time_s - *shared_s_ < options_.share_period_s) return;
  shared_s_ = time_s;
  std::map<std::string, Explorer> explorers;
  for (const auto& [name, member] : team) {
    const State& state = states_.at(name);
    if (state.meeting) continue;
    Explorer& explorer = explorers[name];
    explorer = {member.pose, member.footprint, std::nullopt, state.given_up};
    if (state.goal) explorer.goal = state.goal->viewpoint;
    explorer.given_up.insert(explorer.given_up.end(), looked_at_.begin(), looked_at_.end());
    if (state.just_visited) explorer.given_up.push_back(*state.just_visited);
    for (const auto& [until_s, goal] : state.deferred) explorer.given_up.push_back(goal);
  }
  frontiers_.clear();
  const auto goals = share_frontiers(planner, explorers, options_.exploration, &frontiers_);
  for (const auto& [name, member] : team) {
    State& state = states_.at(name);
    if (state.meeting) continue;
    const auto found = goals.find(name);
    if (found != goals.end()) {
      set_goal(planner, state, found->second, time_s);
    } else if (!state.goal || !state.turning) {
      const auto turn = turn_to_look(planner, state, member.pose);
      set_goal(planner, state, turn, time_s);
      state.turning = turn.has_value();
    }
  }
}

/// Where lasers see half around, and not to the end of a corridor, a robot knows next to nothing of the
/// ground about it as long as it stands where it begins.
std::optional<ExplorationGoal> Expedition::turn_to_look(const Planner& planner, State& state,
                                                        const ManifoldPose& pose) const {
  if (state.turns >= options_.first_turns || apart_m(planner, *state.first, pose) > options_.arrival_m)
    return std::nullopt;
  ++state.turns;
  ManifoldPose turned = pose;
  turned.patch_from_object.yaw =
      wrap_angle(turned.patch_from_object.yaw + 2 * std::numbers::pi / options_.first_turns);
  return ExplorationGoal{turned, 0, 0, 0};
}

void Expedition::set_goal(const Planner& planner, State& state, const std::optional<ExplorationGoal>& goal,
                          double time_s) {
  if (!goal) {
    state.goal.reset();
    state.just_visited.reset();
    return;
  }
  const bool is_same =
      state.goal && !state.turning &&
      apart_m(planner, state.goal->viewpoint, goal->viewpoint) <= options_.exploration.same_goal_m;
  if (!is_same) {
    state.number = static_cast<std::int64_t>(++counts_.goals);
    state.moved_s = state.free_s = time_s;
  }
  state.goal = goal;
  state.turning = state.meeting = false;
}

std::map<std::string, Traveller> Expedition::travellers(Planner& planner,
                                                        const std::map<std::string, ExpeditionMember>& team) {
  std::map<std::string, Traveller> travellers;
  for (const auto& [name, member] : team) {
    State& state = states_.at(name);
    Traveller& traveller = travellers[name];
    traveller = {member.pose, member.footprint, {}};
    if (!state.goal) continue;
    if (state.turning) {  // wherever it stands
      traveller.path = {member.pose};
      continue;
    }
    Path path = planner.path({member.pose, state.goal->viewpoint, member.footprint});
    if (path.refusal == Refusal::none) {
      traveller.path = std::move(path.poses);
    } else {
      give_up(state);
    }
  }
  return travellers;
}

ExplorationOrder Expedition::order(const std::string& name, Clearance clearance, double time_s) {
  State& state = states_.at(name);
  if (state.leave != Leave::go && clearance.leave == Leave::go) state.moved_s = time_s;
  counts_.gave_way += clearance.leave == Leave::give_way && state.leave != Leave::give_way;
  state.leave = clearance.leave;
  ExplorationOrder order{OrderReason::finished, state.goal, state.number, std::move(clearance.path), false};
  if (clearance.leave == Leave::give_way) {
    order.reason = OrderReason::give_way;
  } else if (state.goal) {
    order.reason = clearance.leave != Leave::go ? OrderReason::wait
                   : state.meeting              ? OrderReason::meet
                                                : OrderReason::frontier;
    order.is_last = clearance.leave == Leave::go;
  }
  return order;
}

}  // namespace isthmus
