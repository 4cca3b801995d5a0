#include <algorithm>
#include <iterator>

#include "server/engine/closures/closures.hpp"

namespace isthmus {
namespace {

constexpr std::size_t most_kept = 400;  // of the sightings that say what is forbidden, the newest

}  // namespace

std::string Closures::forbid(World world, ClosureId id, bool must_be_accepted) {
  const auto found = closures_.find(id);
  if (found == closures_.end()) {
    if (must_be_accepted) return "no_such_closure";
    forbidden_.insert(id);
    return "";
  }
  Closure& closure = found->second;
  if (must_be_accepted && closure.record.state != ClosureState::accepted) return "not_accepted";
  closure.forbidden = true;
  if (trial_ && trial_->proposal().id == id) {
    closure.joining = as_mapped(trial_->map(), closure.joining);
    trial_.reset();
  }
  if (closure.record.state == ClosureState::accepted) {
    put_off_trial();  // it was begun on a map that will no longer be
    take_back(world, closure);
    closure.record.state = ClosureState::withdrawn;
  } else {
    closure.record.state = ClosureState::refused;
  }
  closure.record.reason = Reason::forbidden;
  if (closure.from_scans) rule(closure);
  for (const Evidence& evidence : closure.evidence)
    verdict(evidence, Verdict::refused, Reason::forbidden, id);
  std::erase_if(pool_, [&](const Evidence& e) { return records_.verdict(e.record) == Verdict::refused; });
  tried_.clear();
  looked_at_.clear();
  consider_pool_again();
  return "";
}

std::string Closures::allow(ClosureId id) {
  const auto found = closures_.find(id);
  if (found == closures_.end()) return forbidden_.erase(id) > 0 ? "" : "no_such_closure";
  Closure& closure = found->second;
  if (!closure.forbidden) return "not_forbidden";
  closure.forbidden = false;
  forbidden_.erase(id);
  closure.record.reason = Reason::allowed_again;
  for (auto& [other, its] : closures_) {
    if (!its.from_scans || (other != id && its.forbidden_as != id)) continue;
    its.forbidden_as = {};
    rulings_.push_back({other, ClosureState::waiting, closure.record.reason, 0});
  }
  return_to_pool(closure.evidence, closure.record.reason);
  tried_.clear();
  looked_at_.clear();
  consider_pool_again();
  return "";
}

// What was tried out and would be accepted, if nobody had forbidden it.
bool Closures::refuse_if_forbidden(World world, ClosureId id, const Map& tried) {
  if (!forbidden_.contains(id)) return refuse_as_forbidden(world, id, tried);
  Closure& closure = closures_.at(id);
  closure.forbidden = true;
  closure.joining = as_mapped(tried, closure.joining);
  closure.record.state = ClosureState::refused;
  closure.record.reason = Reason::forbidden;
  for (const Evidence& evidence : closure.evidence)
    verdict(evidence, Verdict::refused, Reason::forbidden, id);
  if (closure.from_scans) rule(closure);
  return true;
}

// What says once more what is forbidden already. Sightings are kept with the closure that they speak for.
bool Closures::refuse_as_forbidden(World world, ClosureId id, const Map& tried) {
  const auto forbidden = std::ranges::find_if(closures_, [&](const auto& entry) {
    return entry.second.forbidden && brings_about(world.map, tried, entry.second.joining);
  });
  if (forbidden == closures_.end()) return false;
  Closure& closure = closures_.at(id);
  if (closure.from_scans) {
    closure.record.state = ClosureState::refused;
    closure.record.reason = Reason::forbidden;
    closure.forbidden_as = forbidden->first;
    rule(closure);
    return true;
  }
  for (const Evidence& evidence : closure.evidence)
    verdict(evidence, Verdict::refused, Reason::forbidden, forbidden->first);
  std::vector<Evidence>& kept = forbidden->second.evidence;
  std::ranges::move(closure.evidence, std::back_inserter(kept));
  if (kept.size() > most_kept) kept.erase(kept.begin(), kept.end() - most_kept);
  closures_.erase(id);
  if (id.value + 1 == next_id_) --next_id_;
  return true;
}

void Closures::forget_robot(const std::string& robot) {
  if (trial_) {
    const ClosureId id = trial_->proposal().id;
    trial_.reset();
    put_off(id);
  }
  const auto is_its = [&](const Evidence& evidence) {
    if (evidence.sighting.robot != robot && evidence.target != robot) return false;
    verdict(evidence, Verdict::refused, Reason::robot_dropped);
    return true;
  };
  std::erase_if(pool_, is_its);
  std::erase_if(unplaced_, is_its);
}

}  // namespace isthmus
