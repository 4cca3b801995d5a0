#include "server/engine/record/self_check.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <utility>

namespace isthmus {

void SelfCheck::look_at(const MapCopy& map, std::size_t patches) {
  contradicted_by_.resize(map.patches.size());
  const LaidOut laid_out(map.graph, map.patches, map.poses);
  for (std::size_t i = 0; i < std::min(patches, map.patches.size()); ++i) {
    if (next_ >= map.patches.size()) next_ = 0;
    const PatchId id{static_cast<std::int32_t>(next_)};
    contradicted_by_[next_] = laid_out.contradicted_by(id, options_.compared);
    ++next_;
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
