#include "server/paths/ground/near_patches.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <queue>
#include <set>

namespace isthmus {
namespace {

using Row = std::vector<std::pair<PatchId, float>>;

std::vector<Row> direct_ways(const MapCopy& map) {
  std::vector<Row> ways(map.patches.size());
  for (std::size_t i = 0; i < map.patches.size(); ++i) {
    const PatchId a{static_cast<std::int32_t>(i)};
    for (const PatchId b : map.graph.neighbours(a)) {
      const Pose& from = map.poses[i];
      const Pose& to = map.poses[index(b)];
      ways[i].emplace_back(b, static_cast<float>(std::hypot(to.x - from.x, to.y - from.y)));
    }
  }
  return ways;
}

/// Patches that every way runs through which is there now and was not before; none where ways are gone, or
/// are others. Of ways that are the same, `now` gets what they were measured to be.
std::optional<std::set<PatchId>> ends_of_new_ways(const std::vector<Row>& before, std::vector<Row>& now,
                                                  float bent_m) {
  if (now.size() < before.size()) return std::nullopt;
  std::set<PatchId> ends;
  for (std::size_t i = 0; i < now.size(); ++i) {
    const PatchId own{static_cast<std::int32_t>(i)};
    const Row none;
    const Row& old = i < before.size() ? before[i] : none;
    auto was = old.begin();
    for (auto& [to, way_m] : now[i]) {
      if (was == old.end() || to < was->first) {
        ends.insert(std::max(own, to));
        continue;
      }
      if (was->first < to || std::abs(was->second - way_m) > bent_m) return std::nullopt;
      way_m = (was++)->second;
    }
    if (was != old.end()) return std::nullopt;
  }
  return ends;
}

/// The shorter of what two rows say of each patch.
Row shorter(const Row& one, const Row& other, float other_more_m, float reach_m) {
  Row joined;
  joined.reserve(one.size() + other.size());
  auto a = one.begin();
  for (const auto& [to, from_other_m] : other) {
    const float way_m = from_other_m + other_more_m;
    if (way_m > reach_m) continue;
    while (a != one.end() && a->first < to) joined.push_back(*a++);
    const bool in_both = a != one.end() && a->first == to;
    joined.emplace_back(to, in_both ? std::min(a->second, way_m) : way_m);
    if (in_both) ++a;
  }
  joined.insert(joined.end(), a, one.end());
  return joined;
}

}  // namespace

NearPatches::NearPatches(const MapCopy& map, double reach_m)
    : reach_m_(static_cast<float>(reach_m)), direct_(direct_ways(map)) {
  measure_all();
}

NearPatches NearPatches::kept_up(const MapCopy& map) const {
  NearPatches now;
  now.reach_m_ = reach_m_;
  now.direct_ = direct_ways(map);
  constexpr std::size_t rows_an_end = 8;  // are changed in the time in which one is measured, at least
  const auto ends = ends_of_new_ways(direct_, now.direct_, bent_m);
  if (!ends || rows_an_end * ends->size() > now.direct_.size()) {
    now.direct_ = direct_ways(map);
    now.measure_all();
    return now;
  }
  now.near_ = near_;
  for (std::size_t i = near_.size(); i < now.direct_.size(); ++i)
    now.near_.push_back(std::make_shared<const Row>(Row{{PatchId{static_cast<std::int32_t>(i)}, 0.F}}));
  for (const PatchId end : *ends) now.add_ways_by(end);
  return now;
}

void NearPatches::measure_all() {
  near_.clear();
  std::vector<float> way(direct_.size(), no_way_m);
  for (std::size_t i = 0; i < direct_.size(); ++i)
    near_.push_back(std::make_shared<const Row>(ways_from(PatchId{static_cast<std::int32_t>(i)}, way)));
}

/// Whichever of two patches one comes from, by this one it may be nearer now.
void NearPatches::add_ways_by(PatchId patch) {
  std::vector<float> way(direct_.size(), no_way_m);
  const Row row = ways_from(patch, way);
  for (const auto& [from, way_m] : row) {
    auto& kept = near_[index(from)];
    Row now = shorter(*kept, row, way_m, reach_m_);
    if (now != *kept) kept = std::make_shared<const Row>(std::move(now));
  }
}

/// Dijkstra's search, cut at the reach. `way` is no_way_m all over, before and after.
Row NearPatches::ways_from(PatchId start, std::vector<float>& way) const {
  using Entry = std::pair<float, PatchId>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  Row found;
  way[index(start)] = 0;
  queue.emplace(0.F, start);
  std::vector<PatchId> touched{start};
  while (!queue.empty()) {
    const auto [length, patch] = queue.top();
    queue.pop();
    if (length > way[index(patch)]) continue;
    found.emplace_back(patch, length);
    for (const auto& [next, step] : direct_[index(patch)]) {
      if (!(length + step <= reach_m_ && length + step < way[index(next)])) continue;
      if (way[index(next)] == no_way_m) touched.push_back(next);
      way[index(next)] = length + step;
      queue.emplace(length + step, next);
    }
  }
  for (const PatchId patch : touched) way[index(patch)] = no_way_m;
  std::sort(found.begin(), found.end());
  return found;
}

float NearPatches::way_m(PatchId a, PatchId b) const {
  if (a == b) return 0;
  if (!a.valid() || index(a) >= near_.size()) return no_way_m;
  const Row& ways = *near_[index(a)];
  const auto found = std::lower_bound(ways.begin(), ways.end(), b,
                                      [](const auto& way, PatchId id) { return way.first < id; });
  return found != ways.end() && found->first == b ? found->second : no_way_m;
}

std::vector<std::pair<PatchId, PatchId>> NearPatches::changes(const NearPatches& before) const {
  std::vector<std::pair<PatchId, PatchId>> changed;
  const std::size_t both = std::min(near_.size(), before.near_.size());
  const PatchId end{static_cast<std::int32_t>(both)};
  for (std::size_t i = 0; i < both; ++i) {
    if (near_[i] == before.near_[i]) continue;
    const PatchId a{static_cast<std::int32_t>(i)};
    const auto by_id = [](const auto& one, const auto& other) { return one.first < other.first; };
    Row only_one;
    std::set_symmetric_difference(near_[i]->begin(), near_[i]->end(), before.near_[i]->begin(),
                                  before.near_[i]->end(), std::back_inserter(only_one), by_id);
    for (const auto& [b, way_m] : only_one)
      if (a < b && b < end) changed.emplace_back(a, b);
  }
  return changed;
}

}  // namespace isthmus
