#include "server/engine/mapping.hpp"

namespace isthmus {

// In pieces, so that whoever waits for the end can look at the clock between them; the map is the same
// however many others' work lies between.
bool Engine::Mapping::finish_step(Outcome& outcome) {
  const auto go_on_with = [&](FinishStage stage) {
    finish_stage_ = stage;
    return true;
  };
  switch (finish_stage_) {
    case FinishStage::scans:
      state_.answer_all(outcome);
      for (auto& [name, robot] : state_.robots)
        if (robot.place) state_.record(robot, robot.place->pose, robot.place->odom_from_robot);
      return go_on_with(FinishStage::trial);
    case FinishStage::trial:
      if (state_.closures.step_trial(state_.world())) return true;
      state_.hypotheses.begin_finish(state_.world(), state_.closures);
      return go_on_with(FinishStage::searches);
    case FinishStage::searches:
      if (state_.hypotheses.finish_search(state_.world())) return true;
      state_.hypotheses.try_all_again();
      return go_on_with(FinishStage::finds);
    case FinishStage::finds:
      if (state_.closures.step_trial(state_.world()) ||
          state_.hypotheses.propose_last(state_.world(), state_.closures))
        return true;
      state_.closures.begin_finish(state_.world());
      return go_on_with(FinishStage::sightings);
    case FinishStage::sightings:
      if (state_.closures.finish_step(state_.world())) return true;
      return go_on_with(FinishStage::proximity_matching);
    case FinishStage::proximity_matching:
      if (state_.proximity_matching.finish_step(state_.map, options())) return true;
      islands_to_fit_ = state_.map.graph().islands();
      return go_on_with(FinishStage::fit);
    case FinishStage::fit:
      if (islands_to_fit_.empty()) break;
      state_.map.refit_island(islands_to_fit_.front().front());
      islands_to_fit_.erase(islands_to_fit_.begin());
      return true;
  }
  finish_stage_ = FinishStage::scans;  // whoever goes on may finish again
  return false;
}

std::string_view Engine::Mapping::finishing() const {
  using Stage = FinishStage;
  switch (finish_stage_) {
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
    case Stage::proximity_matching:
      return "matches of nearby patches";
    case Stage::fit:
      return "the last fit";
  }
  return "";
}

}  // namespace isthmus
