#pragma once

#include <cstdint>
#include <vector>

#include "patches/scan.hpp"
#include "tools/simulate/live/reachable_ground.hpp"

namespace isthmus {

/// How much of the reachable ground lasers have seen, from where they truly were.
class SeenGround {
 public:
  explicit SeenGround(const ReachableGround& ground) : ground_(ground), seen_(ground.points().size()) {}

  void add(const Pose& world_from_robot, const Scan& scan, const Laser& laser);

  double share() const;
  /// By the points of the reachable ground.
  const std::vector<std::uint8_t>& seen() const { return seen_; }

 private:
  const ReachableGround& ground_;
  std::vector<std::uint8_t> seen_;
};

}  // namespace isthmus
