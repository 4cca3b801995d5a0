#include "server/engine/engine_state.hpp"
#include "server/engine/robot/teammates.hpp"

namespace isthmus {

void Engine::freeze() {
  State& state = *state_;
  if (state.frozen) return;
  finish();
  state.rendezvous = {};
  for (auto& [name, robot] : state.robots)
    if (robot.place) robot.place->since_last_patch = {};
  state.frozen.emplace(state.map, state.configuration.engine);
}

bool Engine::is_frozen() const { return state_->frozen.has_value(); }

void Engine::State::localise_scan(Robot& robot, const Scan& scan, const Pose& odom_from_robot,
                                  Outcome& outcome) {
  const Laser& laser = robot.declaration.laser;
  const std::vector<Body> bodies =
      teammates_around(map, robots, robot, odom_from_robot, scan.utime, configuration.engine.teammates);
  std::optional<ScanOutcome> done = frozen->take_scan(
      map, robot, observe(without_bodies(scan, laser, bodies), laser, configuration.engine.patch),
      odom_from_robot, configuration.engine);
  if (!done) {
    ++counters.scans_predicted["not_found_yet"];
    return;
  }
  if (done->predicted_reason.empty()) {
    ++counters.scans_matched;
  } else {
    ++counters.scans_predicted[done->predicted_reason];
  }
  settle(robot, std::move(*done), odom_from_robot, outcome);
}

void Engine::State::forget_place(Robot& robot) {
  if (frozen) {
    frozen->restart(robot);
  } else {
    robot.place.reset();
  }
}

}  // namespace isthmus
