#pragma once

#include <sstream>
#include <string>

#include "tools/simulate/live/exploration_run.hpp"

namespace isthmus {

/// A CSV row for each order of an exploration: where the robot is in the plane of its island and in truth,
/// what it is told, where its goal lies, how far it may drive, and for how long it has not got on.
class OrderTable {
 public:
  OrderTable();
  void add(const OrderView& view);
  /// Throws std::runtime_error as AtomicFile does.
  void write(const std::string& path) const;

 private:
  std::ostringstream rows_;
};

}  // namespace isthmus
