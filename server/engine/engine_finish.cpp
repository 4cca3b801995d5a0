#include "server/engine/engine_state.hpp"

namespace isthmus {

// In pieces, so that whoever waits for the end can look at the clock between them; the map is the same
// however many others' work lies between.
bool Engine::State::finish_step(Outcome& outcome) {
  switch (finish_stage) {
    case FinishStage::scans:
      for (auto& [name, robot] : robots) answer_pending(robot, outcome, true);
      if (frozen) return false;
      for (auto& [name, robot] : robots)
        if (robot.place) record(robot, robot.place->pose, robot.place->odom_from_robot);
      finish_stage = FinishStage::trial;
      return true;
    case FinishStage::trial:
      if (closures.step_trial(world())) return true;
      hypotheses.begin_finish(world(), closures);
      finish_stage = FinishStage::searches;
      return true;
    case FinishStage::searches:
      if (hypotheses.finish_search(world())) return true;
      hypotheses.try_all_again();
      finish_stage = FinishStage::finds;
      return true;
    case FinishStage::finds:
      if (closures.step_trial(world())) return true;
      if (hypotheses.propose_last(world(), closures)) return true;
      closures.begin_finish(world());
      finish_stage = FinishStage::sightings;
      return true;
    case FinishStage::sightings:
      if (closures.finish_step(world())) return true;
      finish_stage = FinishStage::weaving;
      return true;
    case FinishStage::weaving:
      if (weaving.finish_step(map, configuration.engine)) return true;
      islands_to_fit = map.graph().islands();
      finish_stage = FinishStage::fit;
      return true;
    case FinishStage::fit:
      if (islands_to_fit.empty()) {
        finish_stage = FinishStage::scans;  // whoever goes on may finish again
        return false;
      }
      map.refit_island(islands_to_fit.front().front());
      islands_to_fit.erase(islands_to_fit.begin());
      return true;
  }
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
