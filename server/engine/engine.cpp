#include "server/engine/engine.hpp"

#include <algorithm>
#include <utility>

#include "server/engine/localising.hpp"
#include "server/engine/mapping.hpp"
#include "server/engine/record/records.hpp"

namespace isthmus {

Engine::Engine(Configuration configuration)
    : state_(std::make_unique<EngineState>(std::move(configuration))) {
  state_->handling = std::make_unique<Mapping>(*state_);
}
Engine::~Engine() = default;
Engine::Engine(Engine&&) noexcept = default;
Engine& Engine::operator=(Engine&&) noexcept = default;

Outcome Engine::handle(const Event& event) {
  EngineState& state = *state_;
  if (is_stranger(event)) return std::visit([&](const auto& body) { return state.take(body); }, event.body);
  Counters& counters = state.counters;
  if (counters.events++ == 0) counters.first_receive_utime = event.receive_utime;
  counters.last_receive_utime = std::max(counters.last_receive_utime, event.receive_utime);
  Outcome outcome = std::visit([&](const auto& body) { return state.take(body); }, event.body);
  // An order that is refused leaves no trace: it is no step of anybody's work either.
  if (std::holds_alternative<CommandEvent>(event.body) && outcome.drop_reason != DropReason::none)
    return outcome;
  for (auto& [name, robot] : state.robots) state.answer_pending(robot, outcome, false);
  state.handling->work(event.receive_utime);
  return outcome;
}

bool Engine::is_stranger(const Event& event) const {
  return std::visit([&](const auto& body) { return state_->is_stranger(body); }, event.body);
}

void Engine::count_dropped(const std::string& robot, DropReason reason, std::int64_t messages) {
  state_->drop(robot, reason, messages);
}

bool Engine::has_queued_work() const {
  const EngineState& state = *state_;
  return state.handling->has_work() ||
         std::any_of(state.robots.begin(), state.robots.end(),
                     [](const auto& entry) { return !entry.second.pending.empty(); });
}

bool Engine::finish_step(Outcome& outcome) { return state_->handling->finish_step(outcome); }

std::string_view Engine::finishing() const { return state_->handling->finishing(); }

Outcome Engine::finish() {
  Outcome outcome;
  while (finish_step(outcome)) {
  }
  return outcome;
}

void Engine::freeze() {
  if (is_frozen()) return;
  finish();
  state_->handling = std::make_unique<Localising>(*state_);
}

bool Engine::is_frozen() const { return !state_->handling->maps(); }

std::vector<LostRobot> Engine::lost_robots() const { return state_->handling->lost_robots(); }

const Configuration& Engine::configuration() const { return state_->configuration; }

MapCopy Engine::copy() const {
  const EngineState& state = *state_;
  state.trajectory->flush();
  MapCopy copy;
  copy.patches.assign(state.map.manifold().patches().begin(), state.map.manifold().patches().end());
  copy.poses.assign(state.map.manifold().poses().begin(), state.map.manifold().poses().end());
  copy.graph = state.map.graph();
  copy.sessions = state.sessions;
  copy.trajectory = state.trajectory;
  copy.trajectory_rows = state.trajectory->size();
  copy.sightings = state.closures.sightings();
  copy.closures = state.closures.closures();
  copy.forbidden = state.closures.forbidden();
  copy.tags = tag_records(state.map, state.tags, state.closures.tags());
  for (const PatchPtr& patch : copy.patches)
    if (state.is_left_out(patch->id)) copy.left_out.push_back(patch->id);
  copy.annotations = state.annotations.records(state.map, state.is_on_map());
  copy.counters = state.counters;
  copy.hypotheses = state.hypotheses.counts();
  copy.finds.assign(state.hypotheses.found().begin(), state.hypotheses.found().end());
  copy.meeting = state.rendezvous.record();
  copy.health = health_records(state.robots, state.counters, state.configuration.engine);
  return copy;
}

}  // namespace isthmus
