#include "server/engine/propagation/proximity_matching.hpp"

namespace isthmus {
void ProximityMatching::stands_on(const std::string& robot, PatchId patch,
                                  const PropagationOptions& options) {
  PatchId& before = stands_on_[robot];
  if (before == patch) return;
  before = patch;
  propagation_.enqueue(patch, options);
}

void ProximityMatching::match_all(const Map& map, const PropagationOptions& options) {
  propagation_.forget_visits();
  for (const PatchPtr& patch : map.manifold().patches()) propagation_.enqueue(patch->id, options);
}

void ProximityMatching::advance(Map& map, const EngineOptions& options, std::int64_t now_utime) {
  const PropagationOptions& its = options.propagation;
  credit_.earn(now_utime, {its.work_share, options.common.max_credit_us});
  if (propagation_.done() || credit_.left_us() < its.step_price_us) return;
  credit_.spend(its.step_price_us);
  propagation_.step(map, options);
}

bool ProximityMatching::finish_step(Map& map, const EngineOptions& options) {
  if (propagation_.done()) return false;
  propagation_.step(map, options);
  return true;
}

}  // namespace isthmus
