#include "server/engine/record/self_check.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <set>
#include <utility>

#include "server/engine/map/contradiction.hpp"

namespace isthmus {
namespace {

/// The patches of a map by their x.
class PatchesAlongX {
 public:
  explicit PatchesAlongX(const MapCopy& map) : map_(map) {
    for (const PatchPtr& patch : map.patches)
      if (patch->tag < 0) along_x_.emplace_back(map.poses[index(patch->id)].x, patch->id);
    std::ranges::sort(along_x_);
  }

  /// On the same island, within a distance and not related to it: so many, the nearest first.
  std::vector<PatchId> unrelated_around(PatchId id, double reach_m, std::size_t most) const {
    const Pose& here = map_.poses[index(id)];
    const IslandId island = map_.graph.island(id);
    const std::vector<PatchId> related = map_.graph.neighbours(id);
    const auto counts = [&](PatchId other) {
      return other != id && map_.graph.island(other) == island &&
             std::ranges::find(related, other) == related.end();
    };
    std::vector<std::pair<double, PatchId>> around;
    const auto first = std::ranges::lower_bound(along_x_, std::pair{here.x - reach_m, PatchId{0}});
    for (auto at = first; at != along_x_.end() && at->first < here.x + reach_m; ++at) {
      const Pose& there = map_.poses[index(at->second)];
      const double away_m = std::hypot(there.x - here.x, there.y - here.y);
      if (away_m < reach_m && counts(at->second)) around.emplace_back(away_m, at->second);
    }
    std::ranges::sort(around);
    around.resize(std::min(around.size(), most));
    std::vector<PatchId> nearest;
    for (const auto& [away_m, other] : around) nearest.push_back(other);
    return nearest;
  }

 private:
  const MapCopy& map_;
  std::vector<std::pair<double, PatchId>> along_x_;
};

}  // namespace

void SelfCheck::look_at(const MapCopy& map, std::size_t patches) {
  contradicted_by_.resize(map.patches.size());
  const PatchesAlongX along_x(map);
  for (std::size_t i = 0; i < std::min(patches, map.patches.size()); ++i) {
    if (next_ >= map.patches.size()) next_ = 0;
    const PatchId id{static_cast<std::int32_t>(next_)};
    std::vector<PatchId>& others = contradicted_by_[next_++];
    others.clear();
    if (map.patches[index(id)]->tag >= 0) continue;
    for (const PatchId other : along_x.unrelated_around(id, options_.reach_m, options_.max_compared)) {
      const std::optional<double> share =
          contradiction(*map.patches[index(id)], *map.patches[index(other)],
                        ominus(map.poses[index(other)], map.poses[index(id)]), options_.contradiction);
      if (share && *share >= options_.min_share) others.push_back(other);
    }
  }
}

// Pairs hang together that have a patch in common.
SelfContradiction SelfCheck::spread_from(std::size_t first, const MapCopy& map,
                                         std::vector<bool>& seen) const {
  SelfContradiction found{
      map.graph.island(PatchId{static_cast<std::int32_t>(first)}), Eigen::Vector2d::Zero(), {}, {}, 0};
  std::set<std::pair<PatchId, PatchId>> pairs;
  std::set<std::string> robots;
  std::vector<PatchId> open = {PatchId{static_cast<std::int32_t>(first)}};
  seen[first] = true;
  while (!open.empty()) {
    const PatchId id = open.back();
    open.pop_back();
    found.patches.push_back(id);
    found.centre_m += Eigen::Vector2d(map.poses[index(id)].x, map.poses[index(id)].y);
    robots.insert(map.patches[index(id)]->robot);
    for (const PatchId other : contradicted_by_[index(id)]) {
      pairs.insert(std::minmax(id, other));
      if (!seen[index(other)]) open.push_back(other);
      seen[index(other)] = true;
    }
  }
  found.centre_m /= static_cast<double>(found.patches.size());
  found.robots.assign(robots.begin(), robots.end());
  found.pairs = static_cast<int>(pairs.size());
  std::ranges::sort(found.patches);
  return found;
}

std::vector<SelfContradiction> SelfCheck::found(const MapCopy& map) const {
  std::vector<SelfContradiction> all;
  std::vector<bool> seen(map.patches.size(), false);
  for (std::size_t i = 0; i < contradicted_by_.size(); ++i) {
    if (seen[i] || contradicted_by_[i].empty()) continue;
    SelfContradiction found = spread_from(i, map, seen);
    if (found.pairs >= options_.min_pairs) all.push_back(std::move(found));
  }
  std::ranges::stable_sort(all, std::ranges::greater{}, &SelfContradiction::pairs);
  return all;
}

std::vector<SelfContradiction> self_contradictions(const MapCopy& map) {
  SelfCheck check;
  check.look_at(map, map.patches.size());
  return check.found(map);
}

}  // namespace isthmus
