#include "server/engine/propagation/weaving.hpp"

namespace isthmus {
namespace {

constexpr std::int64_t step_price_us = 5'000;  // nominal
constexpr CreditRate half_the_time = {0.5, 5'000};

}  // namespace

void Weaving::stands_on(const std::string& robot, PatchId patch) {
  PatchId& before = stands_on_[robot];
  if (before == patch) return;
  before = patch;
  propagation_.enqueue(patch);
}

void Weaving::weave_all(const Map& map) {
  propagation_.forget_visits();
  for (const PatchPtr& patch : map.manifold().patches()) propagation_.enqueue(patch->id);
}

void Weaving::advance(Map& map, const EngineOptions& options, std::int64_t now_utime) {
  credit_.earn(now_utime, half_the_time);
  if (propagation_.done() || credit_.left_us() < step_price_us) return;
  credit_.spend(step_price_us);
  propagation_.step(map, options);
}

bool Weaving::finish_step(Map& map, const EngineOptions& options) {
  if (propagation_.done()) return false;
  propagation_.step(map, options);
  return true;
}

}  // namespace isthmus
