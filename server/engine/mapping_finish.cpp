#include "server/engine/mapping.hpp"

namespace isthmus {

/// In pieces, so that whoever waits for the end can look at the clock between them; the map is the same
/// however many others' work lies between.
bool Mapping::finish_step(Outcome& outcome) {
  if (stage_step(outcome)) return true;
  if (finish_stage_ == FinishStage::sightings) {
    ask_again_what_merged();
    if (state_.hypotheses.has_work()) {  // once more; each time there are fewer islands
      finish_stage_ = FinishStage::searches;
      begin_stage();
      return true;
    }
  }
  if (finish_stage_ == FinishStage::fit) {
    finish_stage_ = FinishStage::scans;  // whoever goes on may finish again
    return false;
  }
  finish_stage_ = static_cast<FinishStage>(static_cast<int>(finish_stage_) + 1);
  begin_stage();
  return true;
}

/// False: the stage is over.
bool Mapping::stage_step(Outcome& outcome) {
  switch (finish_stage_) {
    case FinishStage::scans:
      answer_waiting_scans(outcome);
      return false;
    case FinishStage::trial:
      return state_.closures.step_trial(state_.world());
    case FinishStage::waiting_sightings:
      return state_.closures.try_waiting(state_.world());
    case FinishStage::searches:
      return state_.hypotheses.finish_search(state_.world());
    case FinishStage::finds:
      return state_.closures.step_trial(state_.world()) ||
             state_.hypotheses.propose_last(state_.world(), state_.closures);
    case FinishStage::sightings:
      return state_.closures.finish_step(state_.world());
    case FinishStage::proximity_matching:
      return state_.proximity_matching.finish_step(state_.map, options());
    case FinishStage::fit:
      return fit_next_island();
  }
  return false;
}

void Mapping::begin_stage() {
  switch (finish_stage_) {
    case FinishStage::searches:
      ask_again_what_merged();
      state_.hypotheses.begin_finish(state_.world(), state_.closures);
      return;
    case FinishStage::finds:
      state_.hypotheses.try_all_again();
      return;
    case FinishStage::waiting_sightings:
    case FinishStage::sightings:
      state_.closures.begin_finish(state_.world());
      return;
    case FinishStage::fit:
      islands_to_fit_ = state_.map.graph().islands();
      return;
    case FinishStage::scans:
    case FinishStage::trial:
    case FinishStage::proximity_matching:
      return;
  }
}

void Mapping::answer_waiting_scans(Outcome& outcome) {
  state_.answer_all(outcome);
  for (auto& [name, robot] : state_.robots)
    if (robot.place) state_.record(robot, robot.place->pose, robot.place->odom_from_robot);
}

bool Mapping::fit_next_island() {
  if (islands_to_fit_.empty()) return false;
  state_.map.refit_island(islands_to_fit_.front().front());
  islands_to_fit_.erase(islands_to_fit_.begin());
  return true;
}

std::string_view Mapping::finishing() const {
  using Stage = FinishStage;
  switch (finish_stage_) {
    case Stage::scans:
      return "waiting scans";
    case Stage::trial:
      return "the running trial";
    case Stage::waiting_sightings:
      return "trials of waiting sightings";
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
