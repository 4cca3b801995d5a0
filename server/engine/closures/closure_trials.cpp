#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "server/engine/closures/closures.hpp"

namespace isthmus {
namespace {

constexpr std::int64_t meeting_us = 60'000'000;  // sightings of a loop so far apart are different meetings
constexpr std::size_t most_waiting = 400;        // sightings of one group
constexpr std::size_t most_compared = 24;        // of them, spread evenly, each with each
constexpr std::int64_t step_price_us = 5'000;    // nominal, of one step of a trial
constexpr CreditRate trial_rate = {0.5, 10'000};

std::string pair_key(const Evidence& evidence) {
  const auto [first, second] = std::minmax(evidence.sighting.robot, evidence.target);
  return first + "|" + second;
}

bool observer_is_first(const Map& map, const Evidence& evidence, bool merge, IslandId older) {
  if (merge) return map.graph().island(evidence.observer.pose.patch) == older;
  return evidence.sighting.robot < evidence.target;
}

std::vector<ChartSighting> charts(const Map& map, const std::vector<Evidence>& pool,
                                  const std::vector<std::size_t>& members, bool merge, IslandId older) {
  std::vector<ChartSighting> sightings;
  for (const std::size_t i : members) {
    sightings.push_back(chart_sighting(map, pool[i]));
    sightings.back().observer_in_first = observer_is_first(map, pool[i], merge, older);
  }
  return sightings;
}

// Every so manieth of a group's members, the newest among them.
template <class Group>
Group spread(const Group& group, std::size_t most) {
  Group some = group;
  some.members.clear();
  const std::size_t size = group.members.size();
  for (std::size_t i = 1; i <= most; ++i) some.members.push_back(group.members[i * size / most - 1]);
  return some;
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
  const Pose first_from_chart = first_from_map * alignment.first_from_second;
  joining.first_from_second = first_from_chart * second;
  const Eigen::Matrix3d by_alignment =
      compose_jacobians(first_from_chart, second).by_left *
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

std::vector<std::string> robots_of(const std::vector<Evidence>& evidence) {
  std::set<std::string> names;
  for (const Evidence& e : evidence) {
    names.insert(e.sighting.robot);
    names.insert(e.target);
  }
  return {names.begin(), names.end()};
}

}  // namespace

std::vector<Closures::Group> Closures::groups(World world) const {
  const RelationGraph& graph = world.map.graph();
  std::map<std::string, Group> found;
  std::map<std::string, std::pair<std::string, std::int64_t>> meetings;  // by pair: its group, its last stamp
  for (std::size_t i = 0; i < pool_.size(); ++i) {
    const Evidence& evidence = pool_[i];
    if (!evidence.target_place) continue;
    const IslandId a = graph.island(evidence.observer.pose.patch);
    const IslandId b = graph.island(evidence.target_place->pose.patch);
    Group group{a != b, "", std::min(a, b), std::max(a, b), {}};
    if (group.merge) {
      group.key = "merge " + std::to_string(group.older.value) + " " + std::to_string(group.younger.value);
    } else {
      auto& [key, last] = meetings[pair_key(evidence)];
      if (key.empty() || std::abs(evidence.sighting.utime - last) > meeting_us)
        key = pair_key(evidence) + " " + std::to_string(evidence.record);
      last = evidence.sighting.utime;
      group.key = key;
    }
    found.try_emplace(group.key, group).first->second.members.push_back(i);
  }
  std::vector<Group> all;
  for (auto& [key, group] : found) all.push_back(std::move(group));
  return all;
}

// What has waited in vain for too long, or is too much, is refused.
void Closures::thin(const std::vector<Group>& groups, World world) {
  std::set<std::size_t> gone;
  std::map<std::int32_t, std::size_t> of_unplaced_tag;
  for (std::size_t i = pool_.size(); i-- > 0;)
    if (!pool_[i].target_place && ++of_unplaced_tag[pool_[i].sighting.barcode] > most_waiting) gone.insert(i);
  for (const Group& group : groups) {
    const std::size_t size = group.members.size();
    for (std::size_t k = 0; k < size; ++k) {
      const std::size_t i = group.members[k];
      const bool old = !group.merge && world.now_utime - pool_[i].receive_utime > 2 * meeting_us;
      if (old || k + most_waiting < size) gone.insert(i);
    }
  }
  if (gone.empty()) return;
  std::vector<Evidence> kept;
  for (std::size_t i = 0; i < pool_.size(); ++i) {
    if (gone.contains(i)) {
      verdict(pool_[i], Verdict::refused, pool_[i].doubt);
    } else {
      kept.push_back(std::move(pool_[i]));
    }
  }
  pool_ = std::move(kept);
}

void Closures::propose(World world) {
  if (trial_) return;
  for (const Group& group : groups(world)) {
    const std::size_t waiting = pool_.size();
    if (propose(world, group)) return;
    if (pool_.size() == waiting) continue;
    pool_changed_ = true;  // it was refused at once: the groups are no longer these
    return;
  }
}

bool Closures::propose(World world, const Group& group) {
  // Only what is new can change the answer, but for a lone pair's waiting.
  const std::pair now_looked_at{group.members.size(), pool_[group.members.back()].record};
  if (group.members.size() > 2 && looked_at_[group.key] == now_looked_at && !world.no_more_waiting)
    return false;
  looked_at_[group.key] = now_looked_at;
  const auto tried = tried_.find(group.key);
  const std::size_t least = tried == tried_.end() ? 2 : static_cast<std::size_t>(tried->second * 3 / 2 + 1);
  if (group.members.size() < least) return false;
  if (group.members.size() > most_compared) {
    const bool proposed = propose(world, spread(group, most_compared));
    looked_at_[group.key] = now_looked_at;
    return proposed;
  }
  if (!group.merge && pool_[group.members.front()].is_tag) return propose_by_tag(world, group, least);
  const std::vector<ChartSighting> sightings =
      charts(world.map, pool_, group.members, group.merge, group.older);
  const std::optional<Alignment> alignment = best_alignment(sightings);
  if (!alignment || alignment->supporters.size() < least) return false;
  if (!ready(*alignment, sightings, world.now_utime, world.no_more_waiting)) return false;
  const Evidence& first = pool_[group.members[alignment->supporters.front()]];
  const bool observer_first = observer_is_first(world.map, first, group.merge, group.older);
  begin_trial(world, group, *alignment, joining_of(world.map, first, observer_first, *alignment));
  return trial_ != nullptr;
}

// A tag that the map has far from where it is seen now: a loop. One point does not tell how the two charts
// lie to each other, but where the point is in this one.
bool Closures::propose_by_tag(World world, const Group& group, std::size_t least) {
  const PointConsensus consensus = agree_on_a_point(world.map, pool_, group.members);
  if (!consensus.enough() || consensus.supporters.size() < least ||
      2 * consensus.supporters.size() <= group.members.size())
    return false;
  Alignment alignment;
  for (std::size_t k = 0; k < group.members.size(); ++k)
    if (std::ranges::find(consensus.supporters, group.members[k]) != consensus.supporters.end())
      alignment.supporters.push_back(k);
  const Evidence& first = pool_[consensus.supporters.front()];
  begin_trial(world, group, alignment, joining_of_tag(world.map, first, consensus.point));
  return trial_ != nullptr;
}

// The sightings that agree, out of the pool.
std::vector<Evidence> Closures::take_supporters(const Group& group, const Alignment& alignment) {
  std::set<std::size_t> taken;
  for (const std::size_t s : alignment.supporters) taken.insert(group.members[s]);
  std::vector<Evidence> supporters;
  std::vector<Evidence> rest;
  for (std::size_t i = 0; i < pool_.size(); ++i)
    (taken.contains(i) ? supporters : rest).push_back(std::move(pool_[i]));
  pool_ = std::move(rest);
  return supporters;
}

void Closures::begin_trial(World world, const Group& group, const Alignment& alignment,
                           const Joining& joining) {
  const ClosureId id{next_id_++};
  Closure& closure = closures_[id];
  closure.evidence = take_supporters(group, alignment);
  closure.joining = joining;
  ClosureRecord& record = closure.record;
  record.id = id;
  record.kind = group.merge ? ClosureKind::merge : ClosureKind::closure;
  record.state = ClosureState::waiting;
  record.utime = closure.evidence.front().sighting.utime;
  record.robots = robots_of(closure.evidence);
  record.start_utime = record.end_utime = world.now_utime;
  Proposal proposal;
  proposal.id = id;
  proposal.merge = group.merge;
  proposal.older = group.older;
  proposal.younger = group.younger;
  proposal.older_from_younger = alignment.first_from_second;
  proposal.supporters = static_cast<int>(closure.evidence.size());
  proposal.two_way = alignment.two_way;
  for (const Evidence& evidence : closure.evidence)
    if (auto relation = sighting_relation(world.map, evidence, id)) proposal.relations.push_back(*relation);
  tried_[group.key] = static_cast<int>(closure.evidence.size());
  if (proposal.relations.empty()) {
    record.state = ClosureState::refused;
    record.reason = Reason::no_relation;
    for (const Evidence& evidence : closure.evidence) verdict(evidence, Verdict::refused, record.reason, id);
    return;
  }
  for (const Evidence& evidence : closure.evidence) verdict(evidence, Verdict::waiting, Reason::on_trial, id);
  begin_trial(world, std::move(proposal));
}

// What would bring two islands together as is forbidden is known to before it is tried out.
void Closures::begin_trial(World world, Proposal proposal) {
  const ClosureId id = proposal.id;
  const bool merge = proposal.merge;
  trial_ = std::make_unique<Trial>(world.map, std::move(proposal), world.options, world.now_utime);
  if (merge && refuse_as_forbidden(world, id, trial_->map())) trial_.reset();
}

void Closures::propose_start(World world, const Relation& relation, const std::string& robot,
                             const std::string& with) {
  // The operators measured it: it needs no trial of its truth, only the propagation.
  if (trial_) {
    trial_->finish(world.now_utime);
    end_trial(world);
  }
  const IslandId of_a = world.map.graph().island(relation.a);
  const IslandId of_b = world.map.graph().island(relation.b);
  Proposal proposal;
  proposal.id = ClosureId{next_id_++};
  proposal.merge = of_a != of_b;
  proposal.older = std::min(of_a, of_b);
  proposal.younger = std::max(of_a, of_b);
  const Manifold& manifold = world.map.manifold();
  const Pose a_from_b = std::get<RelativePose>(relation.measurement).a_from_b;
  const Pose of_a_from_of_b = manifold.pose(relation.a) * a_from_b * inverse(manifold.pose(relation.b));
  proposal.older_from_younger = of_a < of_b ? of_a_from_of_b : inverse(of_a_from_of_b);
  proposal.relations = {relation};
  proposal.relations.front().origin.closure = proposal.id;
  proposal.measured = true;
  Closure closure;
  closure.record.id = proposal.id;
  closure.record.kind = proposal.merge ? ClosureKind::merge : ClosureKind::closure;
  closure.record.state = ClosureState::waiting;
  closure.record.reason = Reason::measured_start;
  closure.record.robots = {robot, with};
  closure.record.utime = closure.record.start_utime = world.now_utime;
  const Eigen::Matrix3d& information = std::get<RelativePose>(relation.measurement).information;
  closure.joining = {relation.a, relation.b, a_from_b, information.inverse()};
  closures_.emplace(proposal.id, std::move(closure));
  trial_ = std::make_unique<Trial>(world.map, std::move(proposal), world.options, world.now_utime);
}

// Credit for steps grows with the time that passes, so that no event waits long for a closure.
void Closures::work(World world) {
  credit_.earn(world.now_utime, trial_rate);
  // A new patch is the dearest thing a scan can bring: the trial's turn is at the next event.
  const bool grown = std::exchange(patches_, world.map.manifold().size()) != world.map.manifold().size();
  if (!trial_ || grown) return;
  // Judged at one event, taken over at the next: each may take some milliseconds.
  if (trial_->done()) return end_trial(world);
  trial_->advance(world.now_utime);
  while (!trial_->done() && credit_.left_us() >= step_price_us) {
    if (!trial_->step(world.now_utime)) break;
    credit_.spend(step_price_us);
  }
}

void Closures::end_trial(World world) {
  const std::unique_ptr<Trial> trial = std::move(trial_);
  Closure& closure = closures_.at(trial->proposal().id);
  if (trial->undecided() && !closure.from_scans) return put_off(trial->proposal().id);
  ClosureRecord& record = closure.record;
  record.patches_touched = trial->patches_touched();
  record.work_steps = trial->work_steps();
  record.end_utime = world.now_utime;
  if (trial->undecided()) {
    record.reason = trial->refusal();
    return rule(closure, trial->patches_touched());
  }
  const bool measured = trial->proposal().measured;
  if (trial->accepted() && !measured && refuse_if_forbidden(world, record.id, trial->map()))
    return consider_pool_again();
  if (trial->accepted()) {
    trial->commit(world.map);
    changed_.push_back(trial->proposal().older);
    record.state = ClosureState::accepted;
    const Reason reason = trial->proposal().merge ? Reason::merged_islands : Reason::closed_loop;
    for (const Evidence& evidence : closure.evidence) verdict(evidence, Verdict::accepted, reason, record.id);
    if (closure.from_scans) record.reason = Reason::from_scans;
    tried_.clear();
    looked_at_.clear();
  } else {
    record.state = ClosureState::refused;
    record.reason = trial->refusal();
    for (Evidence evidence : closure.evidence) {
      evidence.doubt = trial->refusal();
      verdict(evidence, Verdict::waiting, evidence.doubt, record.id);
      pool_.push_back(std::move(evidence));
    }
    std::ranges::stable_sort(pool_, {}, &Evidence::record);
  }
  if (closure.from_scans) rule(closure);
  consider_pool_again();
}

// Neither accepted nor refused: as if it had not been proposed yet. Its sightings wait for more.
void Closures::put_off(ClosureId id) {
  const auto found = closures_.find(id);
  if (found->second.from_scans) {
    found->second.record.reason = Reason::map_changed;
    return rule(found->second);
  }
  return_to_pool(found->second.evidence, Reason::too_little_support);
  closures_.erase(found);
  if (id.value + 1 == next_id_) --next_id_;
  consider_pool_again();
}

}  // namespace isthmus
