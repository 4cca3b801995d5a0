#pragma once

#include <deque>
#include <functional>
#include <tuple>
#include <vector>

#include "server/engine/map/surroundings.hpp"

namespace isthmus {

/// A local loop that may be closing: what a new patch would be related to, were it so.
struct LocalLoop {
  PatchId patch;                    ///< the new patch
  std::vector<Relation> relations;  ///< between it and the patches it came back to
  Pose map_from_map;                ///< how the loop moves the new patch in the island's plane
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< of the new patch before it
  bool unambiguous = false;  ///< the window was narrow: nothing else could have been meant
  bool compared = false;     ///< there was something to compare the scan with
  bool would_show = false;   ///< which had in view enough of what the scan sees that it should fit

  auto members() {
    return std::tie(patch, relations, map_from_map, position, unambiguous, compared, would_show);
  }
};

/// What is being looked for: a scan, placed in the frame of the reference of its surroundings, among some of
/// the patches determined relative to it.
struct LoopQuery {
  Pose local_from_robot;
  std::span<const ScanPoint> points;
  std::function<bool(const Determined&)> among;  ///< the patches to match it with, all others left out
  PatchId patch;                                 ///< whose scan it is
  Origin origin;                                 ///< of the relations
  bool whole_window = false;  ///< only where the window searched holds all that the covariance allows
  bool partly_known = false;  ///< what the scan sees need not all be there: judged by the part that is
};

/// Takes the patches asked for, rigidly together around the nearest of them, and matches the scan with them
/// on their own, in a window as wide as the relative covariance says. No relations where nothing fits, where
/// two answers fit about as well, or where there is nothing to match with (`compared` tells these apart).
LocalLoop match_loop(const Map& map, const Surroundings& surroundings, const LoopQuery& query,
                     const EngineOptions& options);

/// Looks for patches that are determined relative to the robot, but less well than eq. 12 asks for, where a
/// scan placed at `local_from_robot` lies (eq. 12's own loops), or that belong to its local map, should
/// overlap the scan, and were not found in it (`unpaired`). Where the window would have to be wider than can
/// be searched at once, and what is found in it might be an alias of what lies outside, hypotheses.hpp looks
/// instead.
LocalLoop find_local_loop(const Map& map, const Surroundings& surroundings, const Pose& local_from_robot,
                          std::span<const ScanPoint> points, std::span<const PatchId> unpaired,
                          PatchId new_patch, const EngineOptions& options);

/// Loops found in wide windows wait here until others, found on the way, say the same.
class WaitingLoops {
 public:
  /// Takes a find. Returns the relations to add to the map now: its own if it is unambiguous, or its own and
  /// those of all that agree with it, once enough of them do over enough of the way. Empty otherwise.
  std::vector<Relation> take(LocalLoop found, const LocalLoopOptions& options);
  void clear() { waiting_.clear(); }

  auto members() { return std::tie(waiting_); }

 private:
  std::deque<LocalLoop> waiting_;
};

}  // namespace isthmus
