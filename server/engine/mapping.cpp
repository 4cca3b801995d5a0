#include "server/engine/mapping.hpp"

#include <limits>
#include <utility>

#include "server/engine/closures/withdrawal.hpp"
#include "server/engine/localise/footprints.hpp"

namespace isthmus {
namespace {

bool is_closure_id(std::int64_t number) {
  return number >= 0 && number <= std::numeric_limits<std::int32_t>::max();
}

}  // namespace

// Once both robots of a measured start are on the map, it is a relation between their first patches.
void Mapping::relate_measured_starts() {
  for (const auto& [name, configured] : state_.configuration.robots) {
    if (!configured.start || state_.starts_related.contains(name)) continue;
    const MeasuredStart& start = *configured.start;
    const auto robot = state_.robots.find(name);
    const auto with = state_.robots.find(start.with);
    if (with == state_.robots.end() || !robot->second.first_patch.valid() ||
        !with->second.first_patch.valid())
      continue;
    state_.starts_related.insert(name);
    Relation relation;
    relation.a = with->second.first_patch;
    relation.b = robot->second.first_patch;
    relation.kind = RelationKind::relative_pose;
    const Eigen::Vector3d weights = start.sigma.cwiseProduct(start.sigma).cwiseInverse();
    relation.measurement = RelativePose{start.with_from_robot, weights.asDiagonal()};
    relation.origin = {OriginKind::start, {}};
    state_.closures.propose_start(state_.world(), relation, name, start.with);
  }
}

// Takes a robot's data so far out of the map; what it sends from now on begins a new island.
DropReason Mapping::drop_data(const std::string& name) {
  Robot* robot = state_.declared(name);
  if (!robot) return DropReason::unknown_robot;
  state_.annotations.leave(name, state_.map, state_.is_on_map());
  state_.closures.forget_robot(name);
  state_.hypotheses.forget_robot(state_.map, name);
  const std::vector<Relation> taken = take_out(state_.map, name, state_.robots);
  EngineState::Dropped& kept = state_.dropped[name];
  kept.relations.insert(kept.relations.end(), taken.begin(), taken.end());
  kept.end = state_.map.manifold().next_id();
  for (std::size_t i = 0; i < robot->pending.size(); ++i) state_.drop(name, DropReason::robot_dropped);
  robot->place.reset();
  robot->history = {};
  robot->pending.clear();
  robot->unplaced.clear();
  robot->local_loops.clear();
  map_changed(state_.map.graph().islands());
  return DropReason::none;
}

DropReason Mapping::take_back_drop(const std::string& name) {
  const auto found = state_.dropped.find(name);
  if (found == state_.dropped.end()) return DropReason::not_dropped;
  for (const Relation& relation : found->second.relations) state_.map.relate(relation);
  state_.dropped.erase(found);
  map_changed(state_.map.graph().islands());
  return DropReason::none;
}

void Mapping::map_changed(const std::vector<std::vector<PatchId>>& islands) {
  state_.island_fits.map_changed();
  state_.proximity_matching.map_changed();
  for (const std::vector<PatchId>& island : islands)
    if (island.size() > 1) state_.island_fits.request(island.front());
}

void Mapping::arrange_meeting() {
  if (!state_.rendezvous.is_due(state_.counters.last_receive_utime)) return;
  state_.rendezvous.choose(state_.map, state_.robots, state_.hypotheses.undecided(),
                           state_.counters.last_receive_utime, options());
}

// Returns why not, or nothing.
DropReason Mapping::obey(const CommandEvent& order) {
  switch (order.verb) {
    case Verb::withdraw:
    case Verb::forbid:
      if (!is_closure_id(order.closure)) return DropReason::no_such_closure;
      return state_.closures.forbid(state_.world(), ClosureId{static_cast<std::int32_t>(order.closure)},
                                    order.verb == Verb::withdraw);
    case Verb::allow:
      if (!order.robot.empty()) return take_back_drop(order.robot);
      if (!is_closure_id(order.closure)) return DropReason::no_such_closure;
      return state_.closures.allow(ClosureId{static_cast<std::int32_t>(order.closure)});
    case Verb::drop:
      return drop_data(order.robot);
    case Verb::refine:
      state_.proximity_matching.match_all(state_.map, options().propagation);
      state_.refine_asked = true;
      return DropReason::none;
    case Verb::send_map:
      return DropReason::none;
  }
  return DropReason::none;
}

void Mapping::work(std::int64_t) {
  state_.closures.advance(state_.world());
  state_.hypotheses.advance(state_.world(), state_.closures);
  for (const PatchId patch : state_.closures.take_changed()) {
    state_.island_fits.map_changed();
    state_.proximity_matching.map_changed();
    state_.island_fits.request(patch);
  }
  ask_again_what_merged();
  state_.proximity_matching.advance(state_.map, options(), state_.counters.last_receive_utime);
  if (state_.refine_asked && !state_.proximity_matching.busy()) {
    state_.refine_asked = false;
    map_changed(state_.map.graph().islands());
  }
  state_.island_fits.advance(state_.map, state_.counters.last_receive_utime, options().map_fit);
  arrange_meeting();
}

void Mapping::ask_again_what_merged() {
  state_.hypotheses.ask_again(state_.map, state_.closures.take_merged(), options().hypotheses);
}

DropReason Mapping::take_way(Robot& robot, const OdometryEvent& event, Outcome& outcome) {
  if (robot.place && event.utime < robot.place->utime - options().intake.backward_us) {
    if (++robot.stale_scans < options().intake.max_stale_scans) return DropReason::stale_stamp;
    robot.place.reset();
  }
  robot.stale_scans = 0;
  if (may_not_begin(robot, options())) return DropReason::too_many_patches;
  if (auto done = take_odometry(state_.map, robot, event.odom_from_robot, event.utime, options()))
    keep(robot, std::move(*done), event.odom_from_robot, outcome);
  return DropReason::none;
}

DropReason Mapping::refusal_of_scans(const Robot& robot) const {
  return may_not_begin(robot, options()) ? DropReason::too_many_patches : DropReason::none;
}

void Mapping::take_scan(Robot& robot, const Scan& scan, const Pose& odom_from_robot, Outcome& outcome) {
  ScanOutcome done = isthmus::take_scan(state_.map, robot, state_.observed(robot, scan, odom_from_robot),
                                        odom_from_robot, options());
  state_.count_scan(done.unmatched);
  const std::string& name = robot.declaration.robot;
  if (done.loop_closed) state_.island_fits.request(done.pose.island);
  if (done.unmatched == Unmatched::no)
    state_.proximity_matching.stands_on(name, done.pose.pose.patch, options().propagation);
  keep(robot, std::move(done), odom_from_robot, outcome);
  const auto met_nobody = state_.rendezvous.take_scan(
      state_.map, state_.robots, name, scan, state_.counters.last_receive_utime, options().rendezvous);
  if (met_nobody) state_.hypotheses.refute(*met_nobody, Reason::met_nobody);
}

void Mapping::keep(Robot& robot, ScanOutcome done, const Pose& odom_from_robot, Outcome& outcome) {
  if (done.patch_refused) state_.drop(robot.declaration.robot, DropReason::too_many_patches);
  if (done.new_session) {
    state_.begin_session(robot, done.pose);
    if (!robot.first_patch.valid()) {
      robot.first_patch = done.pose.pose.patch;
      relate_measured_starts();
    }
  }
  state_.keep_pose(robot, std::move(done), odom_from_robot, outcome);
}

DropReason Mapping::take_sighting(const SightingEvent& event, const std::string& target, bool is_tag) {
  state_.closures.take(event, target, is_tag, state_.counters.last_receive_utime);
  return DropReason::none;
}

void Mapping::refuse_sighting(const SightingEvent& event, Reason reason) {
  state_.closures.refuse(event, reason);
}

void Mapping::restarted(Robot& robot) {
  if (robot.place) state_.record(robot, robot.place->pose, robot.place->odom_from_robot);
  robot.unplaced.clear();
  robot.place.reset();
}

void Mapping::forget_place(Robot& robot) { robot.place.reset(); }

bool Mapping::has_work() const {
  return state_.closures.has_work() || state_.hypotheses.has_work() || state_.island_fits.busy() ||
         state_.proximity_matching.busy();
}

}  // namespace isthmus
