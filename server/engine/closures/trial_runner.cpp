#include "server/engine/closures/trial_runner.hpp"

namespace isthmus {
void TrialRunner::begin(World world, Proposal proposal) {
  trial_ = std::make_unique<Trial>(world.map, std::move(proposal), world.options, world.now_utime);
}

bool TrialRunner::work(World world) {
  const PropagationOptions& its = world.options.propagation;
  credit_.earn(world.now_utime, {its.work_share, world.options.common.max_credit_us});
  // A new patch is the dearest thing a scan can bring: the trial's turn is at the next event.
  const bool grown = std::exchange(patches_, world.map.manifold().size()) != world.map.manifold().size();
  if (!trial_ || grown) return false;
  if (trial_->done()) return true;
  trial_->advance(world.now_utime);
  while (!trial_->done() && credit_.left_us() >= its.step_price_us) {
    if (!trial_->step(world.now_utime)) break;
    credit_.spend(its.step_price_us);
  }
  return false;
}

}  // namespace isthmus
