#include "server/engine/propagation/weaving.hpp"

namespace isthmus {
void Weaving::stands_on(const std::string& robot, PatchId patch, const PropagationOptions& options) {
  PatchId& before = stands_on_[robot];
  if (before == patch) return;
  before = patch;
  propagation_.enqueue(patch, options);
}

void Weaving::weave_all(const Map& map, const PropagationOptions& options) {
  propagation_.forget_visits();
  for (const PatchPtr& patch : map.manifold().patches()) propagation_.enqueue(patch->id, options);
}

void Weaving::advance(Map& map, const EngineOptions& options, std::int64_t now_utime) {
  credit_.earn(now_utime, {options.weaving.work_share, options.weaving.max_credit_us});
  if (propagation_.done() || credit_.left_us() < options.weaving.step_price_us) return;
  credit_.spend(options.weaving.step_price_us);
  propagation_.step(map, options);
}

bool Weaving::finish_step(Map& map, const EngineOptions& options) {
  if (propagation_.done()) return false;
  propagation_.step(map, options);
  return true;
}

}  // namespace isthmus
