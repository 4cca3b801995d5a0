#include "server/engine/hypotheses/hypothesis_pool.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "relations/confidence.hpp"
#include "server/engine/closures/rejudging.hpp"
#include "server/engine/map/surroundings.hpp"
#include "server/engine/map/ways.hpp"
#include "server/engine/places/place_candidates.hpp"

namespace isthmus {
namespace {

bool on_one_island(const Map& map, const Find& find) {
  return map.graph().island(find.query) == map.graph().island(find.anchor);
}

// Whether the map knows well how the patches of a find lie to one another, and that they lie so: a match of
// the two would be taken as it is.
bool agrees_with_map(const Map& map, const Find& find, const EngineOptions& options) {
  if (!on_one_island(map, find)) return false;
  const ConfidenceThreshold known{options.surroundings.loop_position_m, options.surroundings.loop_yaw_rad};
  const auto fits = [&](const Eigen::Matrix3d& covariance) {
    return std::ranges::all_of(find.relations, [&](const Relation& relation) {
      return chi_squared(relation.measurement, map.relative_pose(relation.a, relation.b), covariance) <
             options.common.surprise.bound(3);
    });
  };
  const Eigen::Vector3d widest(known.position_m, known.position_m, known.yaw_rad);
  if (!fits(widest.cwiseAbs2().asDiagonal())) return false;
  const std::optional<Eigen::Matrix3d> covariance = local_relative_covariance(
      map.graph(), map.manifold().poses(), find.anchor, find.query, options.surroundings.confidence_patches);
  return covariance && well_determined(*covariance, known) && fits(*covariance);
}

/// How many finds at least, and how sure in sum, are proposed.
struct Bound {
  std::size_t finds = 1;
  double log_odds = 0;
};

// A loop is tried out where it is more likely true than not: its trial sees more. Two islands may well be two
// buildings that look alike.
Bound bound_of(const Map& map, const Find& find, const EngineOptions& options) {
  if (on_one_island(map, find)) return {1, 0};
  return {static_cast<std::size_t>(options.common.agreeing), options.hypotheses.min_merge_log_odds};
}

/// Among how many places that look alike this is one: so few finds as agree could be of those that are found
/// most surely. That a place is found once only is not confirmed by one find: it may well be one of two. What
/// one find says, more that agree with it do not make less sure.
int look_alikes_of(const std::vector<const Find*>& finds, const Bound& bound) {
  std::vector<int> fewest_first;
  for (const Find* find : finds) fewest_first.push_back(find->look_alikes);
  std::ranges::sort(fewest_first);
  const std::size_t agreeing = std::max<std::size_t>(2, bound.finds);
  const int of_one = bound.finds == 1 ? std::max(2, fewest_first.front()) : std::numeric_limits<int>::max();
  return finds.size() < agreeing ? of_one : std::min(of_one, fewest_first[agreeing - 1]);
}

/// What finds that agree say together.
ScanProposal proposal_of(const Map& map, const Find& first, const std::vector<const Find*>& finds,
                         const EngineOptions& options) {
  ScanProposal proposal;
  proposal.first = first.anchor;
  proposal.second = first.query;
  proposal.first_from_second = first.anchor_from_query;
  if (map.graph().island(first.query) < map.graph().island(first.anchor)) {
    std::swap(proposal.first, proposal.second);
    proposal.first_from_second = inverse(first.anchor_from_query);
  }
  // By the map as it is now: the two may have been on two islands, or elsewhere, when they were found.
  if (on_one_island(map, first))
    proposal.way_m =
        ways_over_relations_m(map, std::span(&first.anchor, 1))[static_cast<std::size_t>(first.query.value)];
  proposal.finds = static_cast<int>(finds.size());
  std::set<std::string> robots;
  for (const Find* find : finds) {
    proposal.cautious = proposal.cautious || find->sigma_m > options.surroundings.reach_m;
    std::ranges::copy(find->relations, std::back_inserter(proposal.relations));
    robots.insert(map.manifold().patch(find->query).robot);
    robots.insert(map.manifold().patch(find->anchor).robot);
  }
  proposal.look_alikes = look_alikes_of(finds, bound_of(map, first, options));
  proposal.robots.assign(robots.begin(), robots.end());
  return proposal;
}

// Where a patch near one end of a find lies by it, on the island of the other end; nothing where it is not
// near.
std::optional<PlaceHint> hint_across(const Map& map, PatchId patch, PatchId near_end, PatchId far_end,
                                     const Pose& far_from_near, const EngineOptions& options) {
  if (map.graph().island(patch) != map.graph().island(near_end)) return std::nullopt;
  const Pose moved = map.relative_pose(near_end, patch);
  const double way_m = std::hypot(moved.x, moved.y);
  if (way_m > options.hypotheses.hint_way_m) return std::nullopt;
  const PlaceCandidateOptions& its = options.place_candidates;
  return PlaceHint{map.graph().island(far_end), map.manifold().pose(far_end) * far_from_near * moved,
                   its.min_drift_m + its.drift_per_way * way_m};
}

}  // namespace

void HypothesisPool::take(World world, const std::string& robot, Find find, HypothesisCounts& counts) {
  ++counts.finds;
  const std::size_t nearest = world.options.surroundings.confidence_patches;
  const NearbyConfidence of_anchor(world.map, find.anchor, nearest);
  const NearbyConfidence of_query(world.map, find.query, nearest);
  std::vector<Agreement> with_others;
  std::optional<std::size_t> once_more;
  for (const Waiting& other : pool_) {
    with_others.push_back(
        agreement(world.map, find, of_anchor, of_query, other.find, world.options.consistency));
    if (other.find.query == find.query && with_others.back() == Agreement::consistent)
      once_more = with_others.size() - 1;
  }
  changed_ = true;
  if (once_more) {  // by a map that says more than when it was found before
    pool_[*once_more].find = std::move(find);
    agreements_.replace(*once_more, with_others);
    return;
  }
  pool_.push_back({std::move(find), robot, {}});
  agreements_.add(std::move(with_others));
  if (pool_.size() > world.options.common.max_finds) {
    std::vector<bool> gone(pool_.size(), false);
    gone.front() = true;
    remove(gone);
  }
}

void HypothesisPool::remove(const std::vector<bool>& gone) {
  std::vector<Waiting> kept;
  for (std::size_t i = 0; i < pool_.size(); ++i)
    if (!gone[i]) kept.push_back(std::move(pool_[i]));
  pool_ = std::move(kept);
  agreements_.remove(gone);
}

void HypothesisPool::advance(World world, Closures& closures, HypothesisCounts& counts) {
  if (changed_ && !closures.on_trial()) changed_ = propose(world, closures, counts);
}

bool HypothesisPool::propose(World world, Closures& closures, HypothesisCounts& counts) {
  std::set<std::vector<std::size_t>> looked_at;
  // The newest find first: what it makes possible is what is new.
  for (std::size_t i = pool_.size(); i-- > 0;) {
    const std::vector<std::size_t> set = agreements_.largest_consistent_with(i, world.options.consistency);
    if (!looked_at.insert(set).second) continue;
    if (!propose(world, closures, set)) continue;
    ++counts.proposed;
    return true;
  }
  return false;
}

bool HypothesisPool::propose(World world, Closures& closures, const std::vector<std::size_t>& set) {
  const Find& first = pool_[set.front()].find;
  const Bound bound = bound_of(world.map, first, world.options);
  const double sure = log_odds(set, world.options.answers_along_way);
  if (set.size() < bound.finds || sure < bound.log_odds ||
      rivals_log_odds(world.map, set, world.options) >= sure)
    return false;
  std::vector<const Find*> finds;
  ClosureId id;
  for (const std::size_t i : set) {
    finds.push_back(&pool_[i].find);
    if (!id.valid()) id = pool_[i].hypothesis;
  }
  if (const auto before = hypotheses_.find(id); before != hypotheses_.end()) {
    if (set.size() < 2 * static_cast<std::size_t>(before->second.tried)) return false;
  }
  ScanProposal proposal = proposal_of(world.map, first, finds, world.options);
  proposal.id = id;
  const TrialOptions& its = world.options.trial;
  proposal.log_odds = std::min(sure, set.size() > 1 ? its.agreed_log_odds : its.lone_log_odds);
  id = closures.propose_from_scans(world, proposal);
  for (Waiting& waiting : pool_)  // an earlier trial of it may have been of others
    if (waiting.hypothesis == id) waiting.hypothesis = {};
  for (const std::size_t i : set) pool_[i].hypothesis = id;
  Hypothesis& hypothesis = hypotheses_[id];
  hypothesis.says = {id, proposal.first, proposal.second, proposal.first_from_second, hypothesis.says.value};
  hypothesis.tried = proposal.finds;
  return true;
}

// The surest is one place or another that looks alike; of those that agree with it, each tells the two apart
// by how often what lies side by side is found at either.
double HypothesisPool::log_odds(const std::vector<std::size_t>& set,
                                const AnswersAlongWayOptions& options) const {
  double surest = -std::numeric_limits<double>::infinity();
  for (const std::size_t i : set) surest = std::max(surest, pool_[i].find.log_odds);
  return surest +
         static_cast<double>(set.size() - 1) * std::log(options.found_where_true / options.found_where_alike);
}

// Of the finds about the same stretches of way that say otherwise, the surest with those that agree with it.
double HypothesisPool::rivals_log_odds(const Map& map, const std::vector<std::size_t>& set,
                                       const EngineOptions& options) const {
  const auto near = [&](PatchId one, PatchId other) {
    if (map.graph().island(one) != map.graph().island(other)) return false;
    const Pose apart = map.relative_pose(one, other);
    return std::hypot(apart.x, apart.y) < options.surroundings.reach_m + options.propagation.slack_m;
  };
  const auto are_near = [&](const Find& rival, const Find& member) {
    return near(rival.query, member.query) || near(rival.query, member.anchor) ||
           near(rival.anchor, member.query) || near(rival.anchor, member.anchor);
  };
  std::vector<std::size_t> rivals = agreements_.rivals_of(set);
  std::erase_if(rivals, [&](std::size_t rival) {
    return std::ranges::none_of(
        set, [&](std::size_t member) { return are_near(pool_[rival].find, pool_[member].find); });
  });
  if (rivals.empty()) return -std::numeric_limits<double>::infinity();
  const std::size_t surest =
      *std::ranges::max_element(rivals, {}, [&](std::size_t i) { return pool_[i].find.log_odds; });
  std::erase_if(rivals, [&](std::size_t i) {
    return i != surest && agreements_.between(i, surest) != Agreement::consistent;
  });
  return log_odds(rivals, options.answers_along_way);
}

void HypothesisPool::take_outcomes(World world, Closures& closures, HypothesisCounts& counts) {
  for (const auto& [id, reason] : std::exchange(refuted_, {})) closures.refuse_from_scans(id, reason);
  for (const ClosureOutcome& outcome : closures.take_outcomes()) {
    if (outcome.state == ClosureState::waiting && parked_.contains(outcome.id)) {
      for (Waiting& waiting : parked_[outcome.id])
        take(world, waiting.robot, std::move(waiting.find), counts);
      parked_.erase(outcome.id);
    } else {
      conclude(world.map, outcome, world.options);
    }
    if (outcome.state == ClosureState::withdrawn) let_go(world, outcome.id, counts);
    if (outcome.state != ClosureState::accepted) continue;
    take_in(world, outcome.id);
    reopen(world, counts);
  }
}

void HypothesisPool::conclude(const Map& map, const ClosureOutcome& outcome, const EngineOptions& options) {
  const auto found = hypotheses_.find(outcome.id);
  if (found == hypotheses_.end()) return;
  changed_ = true;
  if (outcome.state == ClosureState::waiting) {
    found->second.undecided = true;
    found->second.says.value = outcome.value;
    if (outcome.reason == Reason::map_changed) found->second.tried = 0;
    return;
  }
  const bool comes_back = outcome.state == ClosureState::accepted || outcome.reason == Reason::forbidden;
  std::vector<bool> gone(pool_.size(), false);
  for (std::size_t i = 0; i < pool_.size(); ++i) {
    if (pool_[i].hypothesis != outcome.id) continue;
    gone[i] = true;
    if (comes_back) {
      parked_[outcome.id].push_back(pool_[i]);
    } else {
      (on_one_island(map, pool_[i].find) ? refused_loops_ : refused_merges_).push_back(pool_[i]);
    }
  }
  remove(gone);
  hypotheses_.erase(found);
  for (std::vector<Waiting>* refused : {&refused_merges_, &refused_loops_}) {
    const std::size_t kept = std::min(refused->size(), options.common.max_finds);
    refused->erase(refused->begin(), refused->end() - static_cast<std::ptrdiff_t>(kept));
  }
}

// What agrees with the map that an accepted closure has made belongs to it, and goes with it: whatever says
// otherwise later has it against it too.
void HypothesisPool::take_in(World world, ClosureId closure) {
  const auto belongs = [&](const Waiting& waiting) {
    if (!agrees_with_map(world.map, waiting.find, world.options)) return false;
    for (Relation relation : waiting.find.relations) {
      relation.origin = {OriginKind::hypothesis, closure};
      world.map.relate(relation);
    }
    parked_[closure].push_back(waiting);
    return true;
  };
  std::vector<bool> gone;
  for (const Waiting& waiting : pool_) gone.push_back(belongs(waiting));
  remove(gone);
  changed_ = true;
}

// What only agreed with a closure that is withdrawn is as true as before, and what was refused on a map that
// was wrong may fit now.
void HypothesisPool::let_go(World world, ClosureId withdrawn, HypothesisCounts& counts) {
  std::vector<Waiting> free;
  std::erase_if(parked_[withdrawn], [&](const Waiting& waiting) {
    if (waiting.hypothesis == withdrawn) return false;
    free.push_back(waiting);
    return true;
  });
  for (Waiting& waiting : free) take(world, waiting.robot, std::move(waiting.find), counts);
  for (Waiting& waiting : std::exchange(refused_loops_, {}))
    take(world, waiting.robot, std::move(waiting.find), counts);
}

// Finds of a merge that was refused say something else once their islands have merged otherwise: how a loop
// closes.
void HypothesisPool::reopen(World world, HypothesisCounts& counts) {
  std::vector<Waiting> reopened;
  std::erase_if(refused_merges_, [&](const Waiting& waiting) {
    if (!on_one_island(world.map, waiting.find)) return false;
    reopened.push_back(waiting);
    return true;
  });
  for (Waiting& waiting : reopened) take(world, waiting.robot, std::move(waiting.find), counts);
}

void HypothesisPool::try_all_again() {
  for (auto& [id, hypothesis] : hypotheses_) hypothesis.tried = 0;
}

void HypothesisPool::forget_robot(const Map& map, const std::string& robot) {
  const auto is_its = [&](const Waiting& waiting) {
    return map.manifold().patch(waiting.find.query).robot == robot ||
           map.manifold().patch(waiting.find.anchor).robot == robot;
  };
  std::vector<bool> gone;
  for (const Waiting& waiting : pool_) gone.push_back(is_its(waiting));
  remove(gone);
  for (auto& [id, finds] : parked_) std::erase_if(finds, is_its);
  std::erase_if(refused_merges_, is_its);
  std::erase_if(refused_loops_, is_its);
}

std::vector<PlaceHint> HypothesisPool::hints(const Map& map, PatchId patch,
                                             const EngineOptions& options) const {
  std::vector<PlaceHint> hints;
  for (const Waiting& waiting : pool_) {
    const Find& find = waiting.find;
    const auto by_query = hint_across(map, patch, find.query, find.anchor, find.anchor_from_query, options);
    const auto by_anchor =
        hint_across(map, patch, find.anchor, find.query, inverse(find.anchor_from_query), options);
    if (by_query) hints.push_back(*by_query);
    if (by_anchor) hints.push_back(*by_anchor);
  }
  return hints;
}

std::vector<UndecidedHypothesis> HypothesisPool::undecided() const {
  std::vector<UndecidedHypothesis> undecided;
  for (const auto& [id, hypothesis] : hypotheses_)
    if (hypothesis.undecided) undecided.push_back(hypothesis.says);
  return undecided;
}

void HypothesisPool::refute(ClosureId id, Reason reason) {
  const auto found = hypotheses_.find(id);
  if (found == hypotheses_.end()) return;
  std::vector<bool> gone;
  for (const Waiting& waiting : pool_) gone.push_back(waiting.hypothesis == id);
  remove(gone);
  hypotheses_.erase(found);
  refuted_.push_back({id, reason});
}

}  // namespace isthmus
