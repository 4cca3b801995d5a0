#include "server/engine/propagation/weaving.hpp"

#include <algorithm>

namespace isthmus {
namespace {

constexpr std::int64_t step_price_us = 5'000;  // nominal
constexpr std::int64_t most_credit_us = 5'000;

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
  const std::int64_t passed = std::clamp<std::int64_t>(now_utime - last_utime_, 0, 1'000'000);
  last_utime_ = now_utime;
  credit_us_ = std::min(most_credit_us, credit_us_ + passed / 2);
  if (propagation_.done() || credit_us_ < step_price_us) return;
  credit_us_ -= step_price_us;
  propagation_.step(map, options);
}

bool Weaving::finish_step(Map& map, const EngineOptions& options) {
  if (propagation_.done()) return false;
  propagation_.step(map, options);
  return true;
}

}  // namespace isthmus
