#include <algorithm>
#include <iterator>

#include "server/engine/closures.hpp"
#include "server/engine/withdrawal.hpp"

namespace isthmus {

std::string Closures::forbid(World world, ClosureId id, bool must_be_accepted) {
  const auto found = closures_.find(id);
  if (found == closures_.end()) {
    if (must_be_accepted) return "no_such_closure";
    forbidden_.insert(id);
    return "";
  }
  Closure& closure = found->second;
  if (must_be_accepted && closure.record.state != "accepted") return "not_accepted";
  closure.forbidden = true;
  if (trial_ && trial_->proposal().id == id) trial_.reset();
  if (closure.record.state == "accepted") {
    if (trial_) {  // it was begun on a map that will no longer be
      Closure& other = closures_.at(trial_->proposal().id);
      trial_.reset();
      if (other.from_scans) {
        put_off(other.record.id);
      } else {
        other.record.state = "refused";
        other.record.reason = "map_changed";
        std::ranges::copy(other.evidence, std::back_inserter(pool_));
      }
    }
    withdraw(world.map, id, world.robots);
    changed_ = {closure.likeness.first, closure.likeness.second};
    closure.record.state = "withdrawn";
  } else {
    closure.record.state = "refused";
  }
  closure.record.reason = "forbidden";
  if (closure.from_scans) rule(closure);
  for (const Evidence& evidence : closure.evidence) verdict(evidence, "refused", "forbidden", id);
  std::erase_if(pool_, [&](const Evidence& e) { return records_.verdict(e.record) == "refused"; });
  tried_.clear();
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
  closure.record.reason = "allowed_again";
  if (closure.from_scans) rulings_.push_back({id, "waiting", closure.record.reason, 0});
  for (Evidence& evidence : closure.evidence) {
    verdict(evidence, "waiting", "allowed_again");
    pool_.push_back(std::move(evidence));
  }
  closure.evidence.clear();
  std::ranges::stable_sort(pool_, {}, &Evidence::record);
  tried_.clear();
  pool_changed_ = true;
  return "";
}

void Closures::forget_robot(const std::string& robot) {
  if (trial_) {
    const ClosureId id = trial_->proposal().id;
    trial_.reset();
    put_off(id);
  }
  const auto is_its = [&](const Evidence& evidence) {
    if (evidence.sighting.robot != robot && evidence.target != robot) return false;
    verdict(evidence, "refused", "robot_dropped");
    return true;
  };
  std::erase_if(pool_, is_its);
  std::erase_if(unplaced_, is_its);
}

}  // namespace isthmus
