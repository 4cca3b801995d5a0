#include "server/engine/closures/sighting_groups.hpp"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <utility>

namespace isthmus {
namespace {

/// Tells encounters of the same two apart.
class Encounters {
 public:
  explicit Encounters(std::int64_t encounter_us) : encounter_us_(encounter_us) {}

  Encounter of(const Evidence& evidence) {
    const auto [first, second] = std::minmax(evidence.sighting.robot, evidence.target);
    const auto [last, is_new] = last_.try_emplace({first, second});
    auto& [sighting, utime] = last->second;
    if (is_new || std::abs(evidence.sighting.utime - utime) > encounter_us_) sighting = evidence.record;
    utime = evidence.sighting.utime;
    return {first, second, sighting};
  }

 private:
  std::int64_t encounter_us_;
  /// By pair: the first sighting of their last encounter, and the stamp of the last.
  std::map<std::pair<std::string, std::string>, std::pair<std::size_t, std::int64_t>> last_;
};

}  // namespace

std::vector<SightingGroup> groups_of(const Map& map, const std::vector<Evidence>& pool,
                                     const ClosureOptions& options) {
  std::map<GroupKey, SightingGroup> groups;
  Encounters encounters(options.encounter_us);
  for (std::size_t i = 0; i < pool.size(); ++i) {
    if (!pool[i].target_place) continue;
    const IslandId a = map.graph().island(pool[i].observer.pose.patch);
    const IslandId b = map.graph().island(pool[i].target_place->pose.patch);
    const IslandPair islands{std::min(a, b), std::max(a, b)};
    const GroupKey key = a == b ? GroupKey(encounters.of(pool[i])) : GroupKey(islands);
    const SightingGroup empty{key, islands.older, islands.younger, {}};
    groups.try_emplace(key, empty).first->second.members.push_back(i);
  }
  std::vector<SightingGroup> all;
  for (auto& [key, group] : groups) all.push_back(std::move(group));
  return all;
}

std::vector<SightingGroup> smallest_merges_first(const Map& map, std::vector<SightingGroup> groups) {
  std::map<IslandId, std::size_t> patches;
  for (const PatchPtr& patch : map.manifold().patches()) ++patches[map.graph().island(patch->id)];
  std::ranges::stable_sort(groups, {}, [&](const SightingGroup& group) {
    return group.is_merge() ? patches.at(group.older) + patches.at(group.younger) : 0;
  });
  return groups;
}

std::set<std::size_t> superfluous(const std::vector<Evidence>& pool, const std::vector<SightingGroup>& groups,
                                  std::int64_t now_utime, const ClosureOptions& options) {
  const std::size_t max_waiting = options.max_waiting;
  std::set<std::size_t> gone;
  std::map<std::int32_t, std::size_t> of_unplaced_tag;
  for (std::size_t i = pool.size(); i-- > 0;)
    if (!pool[i].target_place && ++of_unplaced_tag[pool[i].sighting.barcode] > max_waiting) gone.insert(i);
  for (const SightingGroup& group : groups) {
    const std::size_t size = group.members.size();
    for (std::size_t k = 0; k < size; ++k) {
      const std::size_t i = group.members[k];
      const bool old = !group.is_merge() && now_utime - pool[i].receive_utime > 2 * options.encounter_us;
      if (old || k + max_waiting < size) gone.insert(i);
    }
  }
  return gone;
}

}  // namespace isthmus
