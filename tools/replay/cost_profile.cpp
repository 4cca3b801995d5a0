#include "tools/replay/cost_profile.hpp"

#include <cmath>

namespace isthmus {
namespace {
constexpr std::size_t max_slots = 4096;
}

void CostProfile::add(double seconds) {
  if (count_ == per_slot_ * max_slots) {
    for (std::size_t i = 0; i < max_slots / 2; ++i) slots_[i] = slots_[2 * i] + slots_[2 * i + 1];
    slots_.resize(max_slots / 2);
    per_slot_ *= 2;
  }
  if (count_ % per_slot_ == 0) slots_.push_back(0);
  slots_.back() += seconds;
  ++count_;
}

double CostProfile::mean_s(double from, double to) const {
  const auto slot_at = [&](double share) {
    const double items = share * static_cast<double>(count_);
    return static_cast<std::size_t>(std::lround(items / static_cast<double>(per_slot_)));
  };
  double sum = 0;
  std::size_t items = 0;
  for (std::size_t i = slot_at(from); i < slot_at(to) && i < slots_.size(); ++i) {
    sum += slots_[i];
    items += i + 1 < slots_.size() ? per_slot_ : count_ - per_slot_ * (slots_.size() - 1);
  }
  return items == 0 ? 0 : sum / static_cast<double>(items);
}

}  // namespace isthmus
