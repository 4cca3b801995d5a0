#include "server/engine/hypotheses/hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace isthmus {
namespace {

bool share_a_patch(const RigidPiece& a, const RigidPiece& b) {
  return std::ranges::any_of(a.local.patches, [&](const LocalPatch& of_a) {
    return std::ranges::any_of(b.local.patches,
                               [&](const LocalPatch& of_b) { return of_a.patch->id == of_b.patch->id; });
  });
}

}  // namespace

void Hypotheses::advance(World world, Closures& closures) {
  hear(world, closures);
  follow(world);
  look_up(world);
  work(world);
  if (pool_changed_ && !closures.on_trial()) pool_changed_ = propose(world, closures);
}

void Hypotheses::begin_finish(World world, Closures& closures) {
  hear(world, closures);
  follow(world);
}

bool Hypotheses::finish_search(World world) {
  if (!has_work()) return false;
  look_up(world);
  if (looking_up_) end_look_up();
  if (can_step()) step(world);
  return true;
}

void Hypotheses::try_all_again() {
  for (auto& [id, hypothesis] : hypotheses_) hypothesis.tried = 0;
}

bool Hypotheses::propose_last(World world, Closures& closures) {
  hear(world, closures);
  return propose(world, closures);
}

// Keeps each robot's way, and asks where it is every few metres of it.
void Hypotheses::follow(World world) {
  for (const auto& [name, robot] : world.robots) {
    if (!robot.place) continue;
    const PatchId patch = robot.place->last_patch;
    PatchId& newest = newest_[name];
    if (patch == newest) continue;
    newest = patch;
    if (!world.map.manifold().patch(patch).points.empty()) note_patch(world, name, patch);
  }
}

void Hypotheses::note_patch(World world, const std::string& robot, PatchId patch) {
  const HypothesisOptions& options = world.options.hypotheses;
  Way& way = ways_[robot];
  const Manifold& manifold = world.map.manifold();
  double step_m = 0;
  if (!way.newest_first.empty()) {
    const PatchId before = way.newest_first.front();
    if (world.map.graph().island(before) == world.map.graph().island(patch)) {
      const Pose moved = manifold.relative_pose(before, patch);
      step_m = std::hypot(moved.x, moved.y);
    } else {
      way = {};
    }
  }
  for (double& from_newest : way.from_newest_m) from_newest += step_m;
  way.newest_first.push_front(patch);
  way.from_newest_m.push_front(0);
  while (way.from_newest_m.back() > options.max_piece_way_m) {
    way.newest_first.pop_back();
    way.from_newest_m.pop_back();
  }
  way.since_query_m += step_m;
  if (way.since_query_m < options.query_every_m || way.from_newest_m.back() < options.min_piece_way_m) return;
  way.since_query_m = 0;
  PlaceQuery query;
  query.newest_first.assign(way.newest_first.begin(), way.newest_first.end());
  query.robot = robot;
  queue_.push_back(std::move(query));
  ++counts_.queries;
  if (queue_.size() > options.max_queries) {
    queue_.pop_front();
    ++counts_.queries_dropped;
  }
}

// All that wait are looked up together, once those before them have had their turn.
void Hypotheses::look_up(World world) {
  if (looking_up_ && looking_up_->is_due(world.now_utime)) end_look_up();
  if (looking_up_ || queue_.empty() || !ready_.empty()) return;
  asked_.assign(std::make_move_iterator(queue_.begin()), std::make_move_iterator(queue_.end()));
  queue_.clear();
  std::vector<PatchId> newest;
  for (const PlaceQuery& query : asked_) newest.push_back(query.newest_first.front());
  looking_up_.emplace(world.map, std::move(newest), world.now_utime, world.options.place_candidates);
}

void Hypotheses::end_look_up() {
  const PlacesJob::Places& places = looking_up_->places();
  for (std::size_t i = 0; i < asked_.size(); ++i) {
    if (asked_[i].newest_first.empty()) continue;
    asked_[i].places = places[i];
    ready_.push_back(std::move(asked_[i]));
  }
  asked_.clear();
  looking_up_.reset();
}

void Hypotheses::work(World world) {
  const HypothesisOptions& its = world.options.hypotheses;
  credit_.earn(world.now_utime, {its.work_share, its.max_credit_us});
  // A new patch is the dearest thing a scan can bring: the search's turn is at the next event.
  const bool grown = std::exchange(patches_, world.map.manifold().size()) != world.map.manifold().size();
  if (credit_.left_us() > 0 && !grown && can_step()) credit_.spend(step(world));
}

std::int64_t Hypotheses::step(World world) {
  if (!query_) {
    query_ = std::move(ready_.front());
    ready_.pop_front();
    return begin(world, *query_);
  }
  if (query_->next < query_->places.size()) return search_next(world, *query_);
  const std::int64_t price = decide(world, *query_);
  query_.reset();
  return price;
}

std::int64_t Hypotheses::begin(World world, PlaceQuery& query) {
  const EngineOptions& options = world.options;
  std::ranges::copy(places_on_other_islands(world.map, query.newest_first.front(), options.place_candidates),
                    std::back_inserter(query.places));
  if (!query.places.empty()) query.piece = piece_of_way(world.map, query.newest_first, options.place_search);
  return options.hypotheses.step_price_us;
}

std::int64_t Hypotheses::search_next(World world, PlaceQuery& query) {
  const HypothesisOptions& its = world.options.hypotheses;
  const PlaceCandidate& place = query.places[query.next++];
  ++counts_.places_searched;
  const PlaceSearch search =
      search_place(place_around(world.map, place.anchor, world.options), query.piece, place.window,
                   std::max(place.way_m > 0 ? its.min_score : its.min_score_anywhere,
                            world.options.ambiguity.share * query.best_score),
                   world.options);
  query.exhausted = query.exhausted || search.exhausted;
  for (const PlaceAnswer& answer : search.answers) {
    query.best_score = std::max(query.best_score, answer.score);
    query.answers.push_back(answer);
    query.answers.back().way_m = place.way_m;
    query.answers.back().sigma_m = place.sigma_m;
  }
  return its.step_price_us +
         static_cast<std::int64_t>(its.evaluation_price_us * static_cast<double>(search.evaluations));
}

// Whether the best answer is the only one: all others lie about where it does, or fit clearly worse.
std::int64_t Hypotheses::decide(World world, PlaceQuery& query) {
  std::ranges::stable_sort(query.answers, std::ranges::greater{}, &PlaceAnswer::score);
  if (query.answers.empty()) return 0;
  if (query.exhausted || !is_unique(world.map, query.answers, world.options)) {
    ++counts_.ambiguous;
    return 0;
  }
  const PlaceAnswer& best = query.answers.front();
  const RigidPiece place = place_around(world.map, best.anchor, world.options);
  // While the query waited, the map may have come to know how the two lie.
  if (share_a_patch(place, query.piece)) return 0;
  std::optional<Find> find = refine(place, query.piece, best, world.options);
  if (find) take(world, query.robot, std::move(*find));
  const HypothesisOptions& its = world.options.hypotheses;
  return static_cast<std::int64_t>(its.decision_steps * static_cast<double>(its.step_price_us));
}

}  // namespace isthmus
