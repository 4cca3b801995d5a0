#include "server/engine/closures/sighting_proposer.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

namespace isthmus {
namespace {

bool observer_is_first(const Map& map, const Evidence& evidence, const SightingGroup& group) {
  if (group.is_merge()) return map.graph().island(evidence.observer.pose.patch) == group.older;
  return evidence.sighting.robot < evidence.target;
}

std::vector<ProjectedSighting> projected(const Map& map, const std::vector<Evidence>& pool,
                                         const SightingGroup& group) {
  std::vector<ProjectedSighting> sightings;
  for (const std::size_t i : group.members) {
    sightings.push_back(project_sighting(map, pool[i]));
    sightings.back().observer_in_first = observer_is_first(map, pool[i], group);
  }
  return sightings;
}

// Every so manieth of a group's members, the newest among them.
SightingGroup evenly_taken(SightingGroup group, std::size_t max_members) {
  const std::size_t size = group.members.size();
  if (size <= max_members) return group;
  std::vector<std::size_t> some;
  for (std::size_t i = 1; i <= max_members; ++i) some.push_back(group.members[i * size / max_members - 1]);
  group.members = std::move(some);
  return group;
}

// How the patches of the first of the sightings that agree lie to one another, by what they say together.
Joining joining_of(const Map& map, const Evidence& first, bool observer_first, const Alignment& alignment) {
  Joining joining;
  const PatchId observer = ground_of(map, first.observer.pose.patch);
  const PatchId target = ground_of(map, first.target_place->pose.patch);
  joining.first = observer_first ? observer : target;
  joining.second = observer_first ? target : observer;
  const Pose first_from_map = inverse(map.manifold().pose(joining.first));
  const Pose& second = map.manifold().pose(joining.second);
  const Pose first_from_plane = first_from_map * alignment.first_from_second;
  joining.first_from_second = first_from_plane * second;
  const Eigen::Matrix3d by_alignment =
      compose_jacobians(first_from_plane, second).by_left *
      compose_jacobians(first_from_map, alignment.first_from_second).by_right;
  joining.covariance = by_alignment * alignment.covariance * by_alignment.transpose();
  return joining;
}

// Where a fixed tag lies in the patch that it is seen from.
Joining joining_of_tag(const Map& map, const Evidence& first, const Eigen::Vector2d& point) {
  Joining joining;
  joining.first = first.observer.pose.patch;
  joining.second = first.target_place->pose.patch;
  const Eigen::Vector2d seen = inverse(map.manifold().pose(joining.first)) * point;
  joining.first_from_second = {seen.x(), seen.y(), 0};
  const SightingEvent& s = first.sighting;
  const double sigma_m = std::max(s.range_sigma_m, s.range_m * s.bearing_sigma_rad);
  joining.covariance.diagonal().setConstant(sigma_m * sigma_m);
  joining.point = true;
  return joining;
}

// A tag that the map has far from where it is seen now: a loop. One point does not tell how the two islands
// lie to each other, but where the point is in this one.
std::optional<GroupAgreement> agreement_on_tag(World world, const std::vector<Evidence>& pool,
                                               const SightingGroup& group, std::size_t min_supporters) {
  const PointConsensus consensus = agree_on_a_point(world.map, pool, group.members, world.options.alignment);
  if (!consensus.enough(world.options.evidence) || consensus.supporters.size() < min_supporters ||
      2 * consensus.supporters.size() <= group.members.size())
    return std::nullopt;
  return GroupAgreement{{consensus.supporters.begin(), consensus.supporters.end()},
                        {},
                        false,
                        joining_of_tag(world.map, pool[consensus.supporters.front()], consensus.point)};
}

std::optional<GroupAgreement> agreement_of_islands(World world, const std::vector<Evidence>& pool,
                                                   const SightingGroup& group, std::size_t min_supporters) {
  const std::vector<ProjectedSighting> sightings = projected(world.map, pool, group);
  const std::optional<Alignment> alignment = best_alignment(sightings, world.options.alignment);
  if (!alignment || alignment->supporters.size() < min_supporters) return std::nullopt;
  if (!ready(*alignment, sightings, world.now_utime, world.no_more_waiting, world.options.alignment))
    return std::nullopt;
  const Evidence& first = pool[group.members[alignment->supporters.front()]];
  GroupAgreement agreement;
  for (const std::size_t k : alignment->supporters) agreement.supporters.insert(group.members[k]);
  agreement.older_from_younger = alignment->first_from_second;
  agreement.two_way = alignment->two_way;
  agreement.joining = joining_of(world.map, first, observer_is_first(world.map, first, group), *alignment);
  return agreement;
}

}  // namespace

std::optional<GroupAgreement> SightingProposer::look_at(World world, const std::vector<Evidence>& pool,
                                                        const SightingGroup& group) {
  // Only what is new can change the answer, but for a lone pair's waiting.
  const std::pair now{group.members.size(), pool[group.members.back()].record};
  auto& before = looked_at_[group.key];
  if (group.members.size() > 2 && before == now && !world.no_more_waiting) return std::nullopt;
  before = now;
  const auto tried = tried_.find(group.key);
  std::size_t min_supporters = 2;
  if (tried != tried_.end()) {
    const double enough = world.options.closures.retry_growth * static_cast<double>(tried->second);
    min_supporters = static_cast<std::size_t>(enough) + 1;
  }
  if (group.members.size() < min_supporters) return std::nullopt;
  const SightingGroup some = evenly_taken(group, world.options.closures.max_compared);
  if (!group.is_merge() && pool[some.members.front()].is_tag)
    return agreement_on_tag(world, pool, some, min_supporters);
  return agreement_of_islands(world, pool, some, min_supporters);
}

void SightingProposer::forget() {
  tried_.clear();
  looked_at_.clear();
}

void SightingProposer::forget(IslandId older, IslandId younger) {
  const auto is_of_them = [&](const auto& entry) {
    const auto* merge = std::get_if<IslandPair>(&entry.first);
    if (merge == nullptr) return true;
    return merge->older == older || merge->older == younger || merge->younger == older ||
           merge->younger == younger;
  };
  std::erase_if(tried_, is_of_them);
  std::erase_if(looked_at_, is_of_them);
}

}  // namespace isthmus
