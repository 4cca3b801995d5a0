#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "server/engine/closures/joining.hpp"
#include "server/engine/closures/sighting_groups.hpp"
#include "server/engine/robot/world.hpp"

namespace isthmus {

/// What sightings of a group say together.
struct GroupAgreement {
  std::set<std::size_t> supporters;  ///< those that agree, in the pool
  Pose older_from_younger;           ///< of a merge
  bool two_way = false;              ///< sightings of either direction are among them
  Joining joining;
};

/// Decides which groups of sightings are worth a trial.
class SightingProposer {
 public:
  /// Nothing where too few agree, or nothing is new since it was looked at last.
  std::optional<GroupAgreement> look_at(World world, const std::vector<Evidence>& pool,
                                        const SightingGroup& group);
  /// So many sightings were tried: the next trial needs half as many again.
  void note_trial(const GroupKey& key, std::size_t supporters) { tried_[key] = supporters; }
  /// The map, or what may be accepted, has changed: every group is worth a look.
  void forget();
  /// Two islands have become one, or a loop has been closed on one (both the same): loops, and what joins
  /// others to these, are worth a look. Of others nothing is new.
  void forget(IslandId older, IslandId younger);

  auto members() { return std::tie(tried_, looked_at_); }

 private:
  std::map<GroupKey, std::size_t> tried_;
  std::map<GroupKey, std::pair<std::size_t, std::size_t>> looked_at_;  ///< its size, its newest sighting
};

}  // namespace isthmus
