#include "server/engine/propagation/trial.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "relations/confidence.hpp"
#include "server/engine/map/contradiction.hpp"
#include "server/engine/map/drift.hpp"
#include "server/engine/propagation/shared_part.hpp"

namespace isthmus {
namespace {

std::size_t next_relation(const RelationGraph& graph) {
  std::size_t next = 0;
  for (const auto& [id, relation] : graph.relations()) next = static_cast<std::size_t>(id.value) + 1;
  return next;
}

}  // namespace

Trial::Trial(const Map& map, Proposal proposal, const EngineOptions& options, std::int64_t now_utime)
    : options_(options),
      proposal_(std::move(proposal)),
      map_(map),
      patches_at_start_(map.manifold().size()),
      first_relation_(next_relation(map.graph())),
      propagation_(map.graph(), {OriginKind::propagation, proposal_.id}),
      poses_before_(map.manifold().poses().begin(), map.manifold().poses().end()) {
  if (proposal_.merge) {
    map_.move_island(proposal_.younger, proposal_.older_from_younger);
  } else {
    gate_before_ = map_.relative_pose(ends().first, ends().second);
  }
  for (const Relation& relation : proposal_.relations) map_.relate(relation);
  begin_fit(now_utime, gate_before_.has_value());
}

void Trial::begin_fit(std::int64_t now_utime, bool with_gate) {
  ++fits_;
  matched_at_fit_ = propagation_.matched().size();
  std::optional<FitJob::LoopQuestion> question;
  if (with_gate) {
    RelationGraph before = map_.graph();
    std::vector<RelationId> added;
    for (const auto& [id, relation] : before.relations())
      if (static_cast<std::size_t>(id.value) >= first_relation_) added.push_back(id);
    before.remove(added);
    const std::span<const PatchPtr> patches = map_.manifold().patches();
    const LocaliseOptions& robots = options_.localise;
    question =
        FitJob::LoopQuestion{std::move(before),
                             ends().first,
                             ends().second,
                             proposal_.loop,
                             {{patches.begin(), patches.end()}, robots.max_speed_m_per_s, robots.slack_m},
                             options_.weak_links,
                             options_.place_candidates,
                             proposal_.from_scans};
  }
  job_ = std::make_unique<FitJob>(map_, map_.graph().island(proposal_.relations.front().a), now_utime,
                                  std::move(question), options_.map_fit);
}

std::pair<PatchId, PatchId> Trial::ends() const {
  if (proposal_.revisit) return {proposal_.revisit->anchor, proposal_.revisit->query};
  return {proposal_.relations.front().a, proposal_.relations.front().b};
}

bool Trial::jumps_too_far(const Eigen::Matrix3d& before) const {
  const Pose after = map_.relative_pose(ends().first, ends().second);
  const Eigen::Vector3d jump = wrapped_difference(after, *gate_before_);
  Eigen::Matrix3d covariance = before;
  covariance.diagonal() += proposal_.beyond_covariance;
  return jump.dot(covariance.inverse() * jump) > options_.trial.max_jump.bound(3);
}

// By what the map knows now, and not when it was found: then the two may have been on two islands still. Of
// places that look alike each is as likely as the others, but for where the map has them. How likely it is
// that something was wrong is in the account already.
double Trial::revisit_log_odds(const std::optional<Eigen::Matrix3d>& before) const {
  const PlaceCandidateOptions& its = options_.place_candidates;
  const double one_of_them = -std::log(proposal_.look_alikes);
  if (!blamed_.empty()) return one_of_them;
  if (!before) return std::log(its.slip_probability) + one_of_them;
  const auto& [anchor, query, found, way_m] = *proposal_.revisit;
  return isthmus::revisit_log_odds(found, *gate_before_, *before, way_m, its) + one_of_them;
}

void Trial::end_fit() {
  const FitJob::Result result = job_->take();
  job_.reset();
  if (!result.ok) {
    refusal_ = Reason::fit_failed;
    stage_ = Stage::done;
    return;
  }
  if (!result.blamed.empty()) take_out(result);
  map_.adopt(result.patches, result.poses);
  if (stage_ != Stage::start) return;
  const bool strong = proposal_.supporters >= options_.common.overruling && !proposal_.from_scans;
  if (gate_before_ && result.covariance && !strong && !proposal_.measured && blamed_.empty() &&
      jumps_too_far(*result.covariance)) {
    refusal_ = Reason::implausible_jump;
    stage_ = Stage::done;
    return;
  }
  if (gate_before_ && !proposal_.from_scans)
    proposal_.cautious = !blamed_.empty() || hardly_known(result.covariance);
  account_.rests_on = result.rests_on;
  if (proposal_.revisit) account_.revisit_log_odds = revisit_log_odds(result.covariance);
  for (const Relation& relation : proposal_.relations) {
    propagation_.enqueue(relation.a, options_.propagation);
    propagation_.enqueue(relation.b, options_.propagation);
  }
  // The two may have met where their views do not overlap, but their maps do not far from there.
  for (const PatchId end : {proposal_.relations.front().a, proposal_.relations.front().b})
    for (const PatchId next : map_.graph().nearest_in_graph(end, options_.trial.first_queue))
      propagation_.enqueue(next, options_.propagation);
  stage_ = Stage::propagate;
}

void Trial::take_out(const FitJob::Result& wrong) {
  blamed_ = wrong.blamed;
  map_.remove(blamed_);
  account_.blamed = static_cast<int>(blamed_.size());
  account_.blamed_closure = wrong.blamed_closure;
  account_.blamed_log_odds = wrong.blamed_log_odds;
}

void Trial::advance(std::int64_t now_utime) {
  if (job_ && job_->advance(now_utime)) end_fit();
  if (stage_ == Stage::look_for_layers && layers_->is_due(now_utime)) judge_layers();
}

bool Trial::step(std::int64_t now_utime) {
  if (job_ || stage_ == Stage::look_for_layers || stage_ == Stage::done) return false;
  if (stage_ == Stage::judge) {
    judge(now_utime);
  } else {
    propagate(now_utime);
  }
  return true;
}

// The fit that begins the trial brings what is near to its place, by finds as exactly as by matches and by
// sightings to some centimetres. Where the loop was open by much, or two maps are joined, what is farther off
// comes there only by what matches on the way.
bool Trial::refits() const { return proposal_.merge || proposal_.cautious; }

bool Trial::hardly_known(const std::optional<Eigen::Matrix3d>& covariance) const {
  return !covariance || std::sqrt(covariance->topLeftCorner<2, 2>().trace()) > options_.surroundings.reach_m;
}

// A few dozen places that match tell as much as a thousand: the rest is matched where robots come
// (proximity_matching.hpp). But where either of two maps may lie in the other as a whole, only how much of
// the building matches tells whether they are of one.
bool Trial::tells_enough() const {
  const std::vector<PatchId>& matched = propagation_.matched();
  if (matched.size() < options_.trial.max_matched_scans) return false;
  if (!proposal_.from_scans) return !refits();
  return !proposal_.merge || shared_log_odds(way_m(map_, matched, options_.shared_part),
                                             width_m(map_, matched)) >= options_.trial.min_whole_log_odds;
}

void Trial::propagate(std::int64_t now_utime) {
  const bool enough = tells_enough();
  if (!propagation_.done() && !enough) {
    propagation_.step(map_, options_);
    const auto first_fit = static_cast<std::size_t>(options_.trial.few_matched_scans);
    const std::size_t next_fit = std::max(first_fit, options_.trial.growth * matched_at_fit_);
    if (refits() && propagation_.matched().size() >= next_fit) begin_fit(now_utime, false);
    return;
  }
  if (stage_ == Stage::propagate && !enough) {
    stage_ = Stage::last_propagate;
    propagation_.retry(options_.propagation);
  } else {
    stage_ = Stage::judge;
  }
  if (refits() && (propagation_.matched().size() > matched_at_fit_ || stage_ == Stage::judge))
    begin_fit(now_utime, false);
}

void Trial::finish_step(std::int64_t now_utime) {
  if (job_) end_fit();
  if (stage_ == Stage::look_for_layers) return judge_layers();
  step(now_utime);
}

void Trial::finish(std::int64_t now_utime) {
  while (!done()) finish_step(now_utime);
}

double Trial::mean_contradiction() const {
  const TrialOptions& its = options_.trial;
  const ConfidenceThreshold bound{its.contradiction_bound_m,
                                  options_.common.yaw_rad(its.contradiction_bound_m)};
  ContradictionByPatch found(map_.manifold(), options_.contradiction);
  for (const PatchId a : propagation_.matched()) {
    if (found.pairs() >= its.max_pairs) break;
    const std::vector<PatchId> own = propagation_.same_side(map_, a, options_.propagation);
    std::vector<PatchId> others = map_.graph().neighbours(a);
    std::erase_if(others, [&](PatchId b) { return std::ranges::binary_search(own, b); });
    found.add(a, others);
  }
  // Where sightings and matches agree, what does not match beyond them is where a loop is open still.
  if (!proposal_.from_scans && found.pairs() > 0) return found.mean();
  // Where nothing matched, only patches whose relative pose is very well determined can contradict one
  // another.
  int looked_at = 0;
  for (const PatchId a : propagation_.unmatched()) {
    if (++looked_at > its.max_unmatched) break;
    const std::vector<PatchId> own = propagation_.same_side(map_, a, options_.propagation);
    const auto covariances = local_relative_covariances(map_.graph(), map_.manifold().poses(), a,
                                                        options_.surroundings.confidence_patches);
    std::vector<PatchId> others;
    for (const auto& [b, covariance] : covariances)
      if (b != a && well_determined(covariance, bound) && !std::ranges::binary_search(own, b))
        others.push_back(b);
    found.add(a, others);
  }
  return found.mean();
}

double Trial::own_contradiction() const {
  ContradictionByPatch found(map_.manifold(), options_.contradiction);
  for (const PatchId a : propagation_.matched()) {
    if (found.pairs() >= options_.trial.max_pairs) break;
    found.add(a, propagation_.before().neighbours(a));
  }
  return found.mean();
}

double Trial::sighting_cost() const {
  double sum = 0;
  int rows = 0;
  for (const Relation& relation : proposal_.relations) {
    const Pose a_from_b = map_.relative_pose(relation.a, relation.b);
    const double squared = 2 * cost(relation.measurement, a_from_b);
    sum += std::min(squared, options_.trial.max_relation_cost);
    rows += std::holds_alternative<Correspondences>(relation.measurement) ? 2 : 1;
  }
  return rows > 0 ? sum / rows : 0;
}

// The median: where the map is crooked by itself, as at a patch of a scan that was placed badly, a few
// relations cost much whether the closure is true or not.
double Trial::find_cost() const {
  std::vector<double> costs;
  for (const Relation& relation : proposal_.relations)
    costs.push_back(chi_squared(relation.measurement, map_.relative_pose(relation.a, relation.b)));
  const auto middle = costs.begin() + static_cast<std::ptrdiff_t>(costs.size() / 2);
  std::ranges::nth_element(costs, middle);
  return *middle;
}

void Trial::judge(std::int64_t now_utime) {
  stage_ = Stage::done;
  account_.prior_log_odds = proposal_.prior_log_odds;
  account_.supporters = proposal_.supporters;
  account_.two_way = proposal_.two_way;
  account_.look_alikes = proposal_.look_alikes;
  account_.matched = static_cast<int>(propagation_.matched().size());
  account_.compared = account_.matched + static_cast<int>(propagation_.unmatched().size());
  account_.way_m = way_m(map_, propagation_.matched(), options_.shared_part);
  account_.unmatched_m = unmatched_way_m(map_, propagation_.before(), propagation_.unmatched(),
                                         propagation_.matched(), options_);
  account_.width_m = width_m(map_, propagation_.matched());
  account_.shared_log_odds = shared_log_odds(account_.way_m, account_.width_m);
  if (proposal_.measured) return;
  account_.cost = proposal_.from_scans ? find_cost() : sighting_cost();
  account_.contradiction = mean_contradiction();
  account_.own_contradiction = own_contradiction();
  if (!proposal_.from_scans) return judge_sightings();
  judge_scans();
  if (layers_would_tell()) look_for_layers(now_utime);
}

// Sightings may outweigh walls in free space, what the map was sure of, and that they disagree among
// themselves, by more than their noise: where many say the same, they are true and their noise is not.
void Trial::judge_sightings() {
  const TrialOptions& its = options_.trial;
  account_.sighting_log_odds = log_odds_of_agreeing(static_cast<std::size_t>(proposal_.supporters), its);
  const double by_sightings =
      its.log_odds_per_sighting_cost * std::max(0.0, account_.cost - its.even_sighting_cost);
  account_.fit_log_odds = -by_sightings - log_odds_by_walls();
  refusal_ = refusal_of_sightings(by_sightings > 0);
  const int enough = proposal_.two_way ? its.min_support_two_way : options_.common.overruling;
  if (refusal_ == Reason::none)
    undecided_ = account_.matched < options_.common.agreeing && proposal_.supporters < enough;
}

Reason Trial::refusal_of_sightings(bool disagree) const {
  const bool outweighs = account_.log_odds() >= options_.trial.min_loop_log_odds;
  if (disagree && !outweighs) return Reason::sightings_disagree;
  if (puts_walls_in_free_space(account_.contradiction) && !outweighs) return Reason::walls_in_free_space;
  if (scans_disagree()) return Reason::scans_disagree;
  if (!blamed_.empty() && !outweighs) return Reason::sightings_disagree;
  return Reason::none;
}

double Trial::log_odds_by_walls() const {
  return options_.trial.log_odds_per_contradiction *
         std::max(0.0, account_.contradiction - account_.own_contradiction);
}

bool Trial::puts_walls_in_free_space(double contradiction) const {
  return contradiction > options_.trial.max_contradiction + account_.own_contradiction;
}

bool Trial::scans_disagree() const {
  const TrialOptions& its = options_.trial;
  return account_.compared >= options_.common.agreeing &&
         account_.matched < its.min_matched_share * account_.compared;
}

// By how much of the building matches: what only looks alike does so over so much more seldom, but for
// corridors that repeat themselves from end to end, and wings that repeat one another whole. Where it is
// known to look alike along the way, the way tells the places apart that the map has, and nothing of one that
// it does not have yet.
double Trial::shared_log_odds(double way_m, double width_m) const {
  const TrialOptions& its = options_.trial;
  const double by_way = its.log_odds_per_way_m * way_m;
  const double by_width = its.log_odds_per_width_m * width_m;
  const bool is_told_by_way = proposal_.look_alikes <= 1;
  if (proposal_.merge) return is_told_by_way ? by_way + by_width : by_width;
  const auto unless_repeated = [&](double log_odds) {
    return -std::log(its.repeats_probability + (1 - its.repeats_probability) * std::exp(-log_odds));
  };
  return unless_repeated(by_width) + (is_told_by_way ? unless_repeated(by_way) : 0);
}

// Without sightings, guard against perceptual aliasing: many buildings repeat themselves.
void Trial::judge_scans() { proposal_.merge ? judge_merge() : judge_loop(); }

// Nothing but the account decides: that few patches match, or some do not, is in it.
void Trial::judge_loop() {
  const TrialOptions& its = options_.trial;
  const double by_finds = its.log_odds_per_find_cost * std::max(0.0, account_.cost - its.even_find_cost);
  const double by_scans = log_odds_by_walls();
  account_.fit_log_odds = -by_finds - by_scans;
  account_.shared_log_odds -= its.log_odds_per_unmatched_m * account_.unmatched_m;
  if (account_.log_odds() < -its.min_loop_log_odds) {
    refusal_ = by_finds > by_scans ? Reason::finds_disagree : Reason::walls_in_free_space;
  } else {
    accept_or_wait();
  }
}

void Trial::accept_or_wait() {
  const TrialOptions& its = options_.trial;
  undecided_ = account_.log_odds() < its.min_loop_log_odds;
  refusal_ = Reason::none;
  if (undecided_)
    refusal_ = account_.width_m < its.min_width_m ? Reason::one_corridor : Reason::too_little_support;
}

bool Trial::layers_would_tell() const {
  const TrialOptions& its = options_.trial;
  return !proposal_.merge && account_.matched + account_.compared > 0 &&
         std::abs(account_.log_odds() - its.min_loop_log_odds) <= its.max_layers_log_odds;
}

void Trial::look_for_layers(std::int64_t now_utime) {
  stage_ = Stage::look_for_layers;
  layers_.emplace(map_, map_.graph().island(proposal_.older), propagation_.before(), poses_before_, now_utime,
                  options_.map_fit);
}

// A map that is right hardly contradicts itself: a few pairs more or less, of people, doors and glass, say
// nothing (record/self_check.hpp).
void Trial::judge_layers() {
  const TrialOptions& its = options_.trial;
  stage_ = Stage::done;
  account_.layers_before = layers_->pairs().before;
  account_.layers_after = layers_->pairs().after;
  layers_.reset();
  const int fewer = account_.layers_before - account_.layers_after;
  const int beyond_even = std::max(0, std::abs(fewer) - its.even_layered_pairs);
  account_.layers_log_odds =
      std::copysign(std::min(its.log_odds_per_layered_pair * beyond_even, its.max_layers_log_odds), fewer);
  accept_or_wait();
}

void Trial::judge_merge() {
  const TrialOptions& its = options_.trial;
  if (account_.cost > its.max_find_cost) {
    refusal_ = Reason::finds_disagree;
  } else if (puts_walls_in_free_space(account_.contradiction)) {
    refusal_ = Reason::walls_in_free_space;
  } else if (scans_disagree()) {
    refusal_ = Reason::scans_disagree;
  } else if (account_.matched < its.few_matched_scans) {
    leave_undecided(Reason::too_little_support);
  } else {
    judge_shared_part();
  }
}

void Trial::judge_shared_part() {
  const TrialOptions& its = options_.trial;
  const std::vector<PatchId> island = map_.graph().patches_of(map_.graph().island(proposal_.older));
  const auto is_younger = [&](PatchId id) { return propagation_.before().island(id) == proposal_.younger; };
  const SharedPart shared = shared_part(map_, island, is_younger, propagation_.matched(), options_);
  account_.own_m = std::min(shared.own_first_m, shared.own_second_m);
  account_.border_contradiction = shared.border_contradiction;
  if (puts_walls_in_free_space(account_.border_contradiction)) {
    refusal_ = Reason::walls_in_free_space;
  } else if (account_.way_m < its.min_way_m) {
    leave_undecided(Reason::too_little_support);
  } else if (account_.own_m < its.min_own_m && account_.shared_log_odds < its.min_whole_log_odds) {
    leave_undecided(Reason::nothing_beyond_the_seam);
  }
}

void Trial::leave_undecided(Reason why) {
  undecided_ = true;
  refusal_ = why;
}

void Trial::commit(Map& map) const {
  if (proposal_.merge) {
    map.move_island(map.graph().island(proposal_.younger), proposal_.older_from_younger);
  }
  const IslandId island = map_.graph().island(proposal_.older);
  map.adopt(map_.graph().patches_of(island), map_.manifold().poses());
  for (const auto& [id, relation] : map_.graph().relations()) {
    if (static_cast<std::size_t>(id.value) >= first_relation_) map.relate(relation);
  }
  if (!account_.blamed_closure.valid()) map.remove(blamed_);
}

}  // namespace isthmus
