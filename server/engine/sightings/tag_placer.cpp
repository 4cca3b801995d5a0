#include "server/engine/sightings/tag_placer.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "server/engine/sightings/placing.hpp"

namespace isthmus {
namespace {

// Whether the sightings of a tag that are left would have placed it.
bool is_still_placed(const Map& map, const std::vector<Relation>& left, const EvidenceOptions& options) {
  double apart_m = 0;
  for (const Relation& relation : left) {
    const Pose apart = map.relative_pose(left.front().a, relation.a);
    apart_m = std::max(apart_m, std::hypot(apart.x, apart.y));
  }
  return places_a_point(left.size(), apart_m, options);
}

std::vector<Relation> relations_of(const RelationGraph& graph, PatchId patch) {
  std::vector<Relation> relations;
  for (const RelationId id : graph.of(patch)) relations.push_back(*graph.find(id));
  return relations;
}

}  // namespace

void TagPlacer::place(World world, MutualObservations& observations) {
  const std::vector<Evidence>& pool = observations.pool();
  std::map<std::pair<std::int32_t, IslandId>, std::vector<std::size_t>> sightings;
  for (std::size_t i = 0; i < pool.size(); ++i) {
    if (pool[i].target_place) continue;
    const IslandId island = world.map.graph().island(pool[i].observer.pose.patch);
    sightings[{pool[i].sighting.barcode, island}].push_back(i);
  }
  std::set<std::size_t> used;
  bool any = false;
  for (const auto& [key, members] : sightings) {
    if (members.size() < 2 || patches_.contains(key.first)) continue;
    const auto newest =
        static_cast<std::ptrdiff_t>(std::min(members.size(), world.options.closures.max_compared));
    any = place(world, key.first, {members.end() - newest, members.end()}, observations, used) || any;
  }
  if (!any) return;
  observations.take_out(used);
  observations.consider_again(patches_);
}

bool TagPlacer::place(World world, std::int32_t barcode, const std::vector<std::size_t>& members,
                      MutualObservations& observations, std::set<std::size_t>& used) {
  const std::vector<Evidence>& pool = observations.pool();
  const EngineOptions& options = world.options;
  const PointConsensus consensus = agree_on_a_point(world.map, pool, members, options.alignment);
  if (!consensus.enough(options.evidence)) return false;
  const Evidence& first = pool[consensus.supporters.front()];
  if (is_beside_another(world, world.map.graph().island(first.observer.pose.patch), consensus)) {
    for (const std::size_t i : consensus.supporters) observations.doubt(i, Reason::another_tag_is_there);
    return false;
  }
  const PatchId id = world.map.manifold().next_id();
  world.map.add(make_tag_patch(id, barcode, first.sighting.utime),
                {consensus.point.x(), consensus.point.y(), 0});
  patches_[barcode] = id;
  for (const std::size_t i : consensus.supporters) {
    Evidence seen = pool[i];
    seen.target_place = place_of_tag(id, seen.sighting.utime);
    world.map.relate(*sighting_relation(world.map, seen, {}, options.alignment, options.evidence));
    observations.set_verdict(std::span(&pool[i], 1), Verdict::accepted, Reason::placed_tag);
    used.insert(i);
  }
  world.map.refit_around(id, options.map_fit.window_patches);
  return true;
}

// A misread barcode repeats itself where another tag hangs: so near one, a tag needs more to be believed.
bool TagPlacer::is_beside_another(World world, IslandId island, const PointConsensus& consensus) const {
  const Map& map = world.map;
  const CommonOptions& its = world.options.common;
  if (consensus.supporters.size() >= static_cast<std::size_t>(its.overruling) &&
      consensus.apart_m >= its.baseline_m)
    return false;
  return std::ranges::any_of(patches_, [&](const auto& tag) {
    const Pose& pose = map.manifold().pose(tag.second);
    return map.graph().island(tag.second) == island &&
           std::hypot(pose.x - consensus.point.x(), pose.y - consensus.point.y()) <
               world.options.closures.another_tag_m;
  });
}

void TagPlacer::displace(Map& map, std::vector<Relation>& gone, const EvidenceOptions& options) {
  std::set<PatchId> touched;
  for (const Relation& relation : gone) touched.insert({relation.a, relation.b});
  for (auto tag = patches_.begin(); tag != patches_.end();) {
    const std::vector<Relation> left = relations_of(map.graph(), tag->second);
    const bool of_closures =
        std::ranges::any_of(left, [](const Relation& relation) { return relation.origin.closure.valid(); });
    if (!touched.contains(tag->second) || of_closures || is_still_placed(map, left, options)) {
      ++tag;
      continue;
    }
    std::vector<RelationId> ids;
    for (const Relation& relation : left) ids.push_back(relation.id);
    map.remove(ids);
    std::ranges::copy(left, std::back_inserter(gone));
    tag = patches_.erase(tag);
  }
}

}  // namespace isthmus
