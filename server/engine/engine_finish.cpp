#include "server/engine/engine_state.hpp"

namespace isthmus {

// In pieces, so that whoever waits for the end can look at the clock between them; the map is the same
// however many others' work lies between.
bool Engine::State::finish_step(Outcome& outcome) {
  const auto go_on_with = [&](FinishStage stage) {
    finish_stage = stage;
    return true;
  };
  switch (finish_stage) {
    case FinishStage::scans:
      for (auto& [name, robot] : robots) answer_pending(robot, outcome, true);
      if (frozen) break;
      for (auto& [name, robot] : robots)
        if (robot.place) record(robot, robot.place->pose, robot.place->odom_from_robot);
      return go_on_with(FinishStage::trial);
    case FinishStage::trial:
      if (closures.step_trial(world())) return true;
      hypotheses.begin_finish(world(), closures);
      return go_on_with(FinishStage::searches);
    case FinishStage::searches:
      if (hypotheses.finish_search(world())) return true;
      hypotheses.try_all_again();
      return go_on_with(FinishStage::finds);
    case FinishStage::finds:
      if (closures.step_trial(world()) || hypotheses.propose_last(world(), closures)) return true;
      closures.begin_finish(world());
      return go_on_with(FinishStage::sightings);
    case FinishStage::sightings:
      if (closures.finish_step(world())) return true;
      return go_on_with(FinishStage::weaving);
    case FinishStage::weaving:
      if (weaving.finish_step(map, configuration.engine)) return true;
      islands_to_fit = map.graph().islands();
      return go_on_with(FinishStage::fit);
    case FinishStage::fit:
      if (islands_to_fit.empty()) break;
      map.refit_island(islands_to_fit.front().front());
      islands_to_fit.erase(islands_to_fit.begin());
      return true;
  }
  finish_stage = FinishStage::scans;  // whoever goes on may finish again
  return false;
}

std::string_view Engine::finishing() const {
  using Stage = State::FinishStage;
  switch (state_->finish_stage) {
    case Stage::scans:
      return "waiting scans";
    case Stage::trial:
      return "the running trial";
    case Stage::searches:
      return "searches";
    case Stage::finds:
      return "trials of finds";
    case Stage::sightings:
      return "trials of sightings";
    case Stage::weaving:
      return "weaving";
    case Stage::fit:
      return "the last fit";
  }
  return "";
}

bool Engine::finish_step(Outcome& outcome) { return state_->finish_step(outcome); }

Outcome Engine::finish() {
  Outcome outcome;
  while (finish_step(outcome)) {
  }
  return outcome;
}

}  // namespace isthmus
