#pragma once

#include <cstddef>
#include <vector>

namespace isthmus {

/// The cost of many items in their order, in constant memory: neighbouring items are summed into slots, two
/// slots becoming one whenever there are too many.
class CostProfile {
 public:
  void add(double seconds);
  std::size_t count() const { return count_; }

  /// Mean cost of the items in the shares [from, to) of the run; 0 where there are none.
  double mean_s(double from, double to) const;

 private:
  std::size_t per_slot_ = 1;
  std::size_t count_ = 0;
  std::vector<double> slots_;
};

}  // namespace isthmus
