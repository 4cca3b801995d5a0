#include "server/engine/localising.hpp"

#include <utility>

namespace isthmus {

Localising::Localising(EngineState& state) : state_(state), frozen_(state.map, state.configuration.engine) {
  state_.rendezvous = {};
  for (auto& [name, robot] : state_.robots)
    if (robot.place) robot.place->since_last_patch = {};
}

// Its way would have to become a map.
DropReason Localising::take_way(Robot&, const OdometryEvent&, Outcome&) { return DropReason::frozen; }

void Localising::take_scan(Robot& robot, const Scan& scan, const Pose& odom_from_robot, Outcome& outcome) {
  std::optional<ScanOutcome> done =
      frozen_.take_scan(state_.map, robot, state_.observed(robot, scan, odom_from_robot), odom_from_robot,
                        state_.configuration.engine);
  if (!done) {
    state_.count_scan(Unmatched::not_found_yet);
    return;
  }
  state_.count_scan(done->unmatched);
  if (done->new_session) state_.begin_session(robot, done->pose);
  state_.keep_pose(robot, std::move(*done), odom_from_robot, outcome);
}

// It changes nothing of the map, but may tell where a robot is.
DropReason Localising::take_sighting(const SightingEvent& event, const std::string& target, bool is_tag) {
  const bool tells = frozen_.take_sighting(state_.map, state_.robots, event, target, is_tag,
                                           state_.configuration.engine.frozen);
  return tells ? DropReason::none : DropReason::frozen;
}

DropReason Localising::obey(const CommandEvent&) { return DropReason::frozen; }

DropReason Localising::take_initial_pose(Robot& robot, const InitialPoseEvent& event) {
  return frozen_.take_given(state_.map, robot, event, state_.configuration.engine.frozen);
}

void Localising::work(std::int64_t receive_utime) {
  frozen_.advance(state_.map, state_.configuration.engine, receive_utime);
}

std::vector<LostRobot> Localising::lost_robots() const {
  const auto is_placed = [&](const std::string& name) {
    const auto robot = state_.robots.find(name);
    return robot != state_.robots.end() && robot->second.place.has_value();
  };
  return frozen_.lost(is_placed, state_.configuration.engine);
}

bool Localising::finish_step(Outcome& outcome) {
  state_.answer_all(outcome);
  return false;
}

}  // namespace isthmus
