#pragma once

#include <map>
#include <string>
#include <vector>

#include "server/engine/map/map.hpp"
#include "server/engine/robot/pose_history.hpp"

namespace isthmus {

/// Where robots were, after islands have parted. A robot drives on what others have mapped without adding to
/// it, so that its way is known by their patches: what was the same island is said by the robot's own patches
/// instead, as the map had them together.
class OwnGround {
 public:
  /// `together`: the map before islands parted. Both must outlive this.
  OwnGround(const Map& together, const Map& parted);

  /// Puts a place of a robot on the newest patch of its own up to then, where the islands have parted
  /// between. Returns whether they have.
  bool put_back(const std::string& robot, PastPlace& place) const;

 private:
  const Map& together_;
  const Map& parted_;
  std::map<std::string, std::vector<PatchId>> own_;  ///< by robot, by time
};

}  // namespace isthmus
