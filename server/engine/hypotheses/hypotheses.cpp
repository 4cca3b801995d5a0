#include "server/engine/hypotheses/hypotheses.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <string>
#include <utility>

#include "server/engine/map/surroundings.hpp"

namespace isthmus {
namespace {

SearchTerms terms_of(const EngineOptions& options) {
  SearchTerms terms;
  terms.min_score = options.hypotheses.min_score;
  terms.min_score_anywhere = options.common.sure_score;
  terms.min_carrier_score = options.localise.min_score;
  terms.on_the_map = true;
  return terms;
}

// Whether a merge, or what came after it, has matched it with others than it was searched for among before:
// then where it is among theirs is known.
bool is_matched_with_others(const Map& map, const PlaceQuery& query) {
  const auto is_of_another = [&](PatchId id) {
    return std::ranges::find(query.not_of, map.manifold().patch(id).robot) == query.not_of.end();
  };
  return std::ranges::any_of(query.newest_first, [&](PatchId id) {
    return std::ranges::any_of(map.graph().of(id), [&](RelationId relation) {
      const Relation& its = *map.graph().find(relation);
      return is_match(its) && is_of_another(its.a == id ? its.b : its.a);
    });
  });
}

}  // namespace

void Hypotheses::advance(World world, Closures& closures) {
  pool_.take_outcomes(world, closures, counts_);
  follow(world);
  look_up(world);
  work(world);
  pool_.advance(world, closures, counts_);
}

void Hypotheses::begin_finish(World world, Closures& closures) {
  pool_.take_outcomes(world, closures, counts_);
  follow(world);
  for (auto& [robot, way] : ways_)  // of what was driven since it was last asked of
    if (way.since_query_m > 0) ask(robot, way, world.options.hypotheses);
}

bool Hypotheses::finish_search(World world) {
  if (!has_work()) return false;
  look_up(world);
  if (looking_up_) end_look_up();
  if (can_step()) step(world);
  return true;
}

bool Hypotheses::propose_last(World world, Closures& closures) {
  pool_.take_outcomes(world, closures, counts_);
  return pool_.propose(world, closures, counts_);
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
  if (!way.recent.newest_first.empty()) {
    const PatchId before = way.recent.newest_first.front();
    if (world.map.graph().island(before) == world.map.graph().island(patch)) {
      const Pose moved = manifold.relative_pose(before, patch);
      step_m = std::hypot(moved.x, moved.y);
    } else {
      way = {};
    }
  }
  way.recent.add(patch, step_m, options.max_piece_way_m);
  way.since_query_m += step_m;
  way.length_m += step_m;
  if (way.since_query_m >= options.query_every_m) ask(robot, way, options);
}

void Hypotheses::ask(const std::string& robot, Way& way, const HypothesisOptions& options) {
  if (way.recent.length_m() < options.min_piece_way_m) return;
  way.since_query_m = 0;
  PlaceQuery query;
  query.newest_first.assign(way.recent.newest_first.begin(), way.recent.newest_first.end());
  query.robot = robot;
  query.at_m = way.length_m;
  queue_.push_back(std::move(query));
  ++counts_.queries;
  if (queue_.size() > options.max_queries) {
    queue_.front().at_m = 0;
    late_.push_back(std::move(queue_.front()));
    queue_.pop_front();
    ++counts_.queries_put_off;
  }
}

void Hypotheses::ask_again(const Map& map, std::span<const std::vector<PatchId>> sides,
                           const HypothesisOptions& options) {
  std::set<PatchId> asked;  // of the first side that it was on: more is new to that than to a later one
  for (const std::vector<PatchId>& side : sides) {
    std::map<std::string, std::vector<PatchId>> ways;
    std::set<std::string> robots;
    for (const PatchId id : side) {
      const Patch& patch = map.manifold().patch(id);
      if (patch.points.empty()) continue;
      robots.insert(patch.robot);
      if (asked.insert(id).second) ways[patch.robot].push_back(id);
    }
    const std::vector<std::string> not_of(robots.begin(), robots.end());
    for (const auto& [robot, patches] : ways)
      for (std::vector<PatchId>& piece : pieces_along(map.manifold(), patches, options)) {
        late_.push_back({std::move(piece), robot, 0, not_of, {}});
        ++counts_.queries;
      }
  }
}

void Hypotheses::next_late(World world) {
  for (std::size_t i = 0; i < world.options.hypotheses.max_queries && !late_.empty(); ++i) {
    PlaceQuery& next = late_.front();
    if (next.not_of.empty() || !is_matched_with_others(world.map, next)) queue_.push_back(std::move(next));
    late_.pop_front();
  }
}

// All that wait are looked up together, once those before them have had their turn.
void Hypotheses::look_up(World world) {
  if (looking_up_ && looking_up_->is_due(world.now_utime)) end_look_up();
  if (looking_up_ || !ready_.empty()) return;
  if (queue_.empty()) next_late(world);
  if (queue_.empty()) return;
  asked_.assign(std::make_move_iterator(queue_.begin()), std::make_move_iterator(queue_.end()));
  queue_.clear();
  std::vector<PlaceQuestion> questions;
  for (const PlaceQuery& query : asked_)
    questions.push_back({query.newest_first,
                         pool_.hints(world.map, query.newest_first.front(), world.options), query.not_of,
                         query.not_of.empty(), query.is_late()});
  looking_up_.emplace(world.map, std::move(questions), world.now_utime, world.options,
                      terms_of(world.options).min_score_anywhere, tables_.of(world.map));
}

void Hypotheses::end_look_up() {
  const PlacesJob::Places& found = looking_up_->places();
  for (std::size_t i = 0; i < asked_.size(); ++i) {
    if (asked_[i].newest_first.empty()) continue;
    asked_[i].search.add(found[i]);
    ready_.push_back(std::move(asked_[i]));
  }
  asked_.clear();
  looking_up_.reset();
}

void Hypotheses::work(World world) {
  const HypothesisOptions& its = world.options.hypotheses;
  credit_.earn(world.now_utime, {its.work_share, world.options.common.max_credit_us});
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
  const SearchTerms terms = terms_of(world.options);
  if (const PlaceCandidate* next = query_->search.next()) {
    ++counts_.places_searched;
    const std::vector<PatchId> own = own_part(world.map, query_->search.piece());
    return query_->search.search_next(places_.around(world.map, next->anchor, own, world.options), terms,
                                      world.options);
  }
  PlaceDecision decision = decide(world, *query_);
  if (decision.find) take(world, query_->robot, *std::move(decision.find));
  query_.reset();
  return decision.price_us;
}

void Hypotheses::take(World world, const std::string& robot, Find find) {
  const HypothesisOptions& options = world.options.hypotheses;
  const bool waits = find.probability() >= options.min_find_probability;
  found_.push_back({robot, find.query, find.anchor, find.anchor_from_query, find.way_m, find.search_score,
                    find.carrier_score, find.seen_again, find.look_alikes, find.log_odds, waits});
  if (found_.size() > options.max_recorded_finds) found_.pop_front();
  if (waits) pool_.take(world, robot, std::move(find), counts_);
}

std::int64_t Hypotheses::begin(World world, PlaceQuery& query) {
  const PlaceSearchOptions& its = world.options.place_search;
  if (query.search.has_places()) query.search.look_for(piece_of_way(world.map, query.newest_first, its));
  return its.step_price_us;
}

PlaceDecision Hypotheses::decide(World world, PlaceQuery& query) {
  const SearchTerms terms = terms_of(world.options);
  if (query.is_late()) {
    PlaceDecision decision = query.search.decide(world.map, terms, world.options);
    counts_.ambiguous += decision.ambiguous ? 1 : 0;
    return decision;
  }
  AnswersAlongWay& along = ways_[query.robot].answers;
  along.add({query.newest_first.front(), query.at_m, query.search.best_first()},
            world.options.answers_along_way);
  PlaceDecision decision = query.search.decide(world.map, terms, world.options);
  if (!decision.ambiguous) return decision;
  ++counts_.ambiguous;
  const std::optional<PlaceAnswer> answer = along.all_but_certain(world.map, world.options);
  if (!answer) return decision;
  decision = query.search.decide_on(*answer, world.map, terms, world.options);
  if (decision.find)
    decision.find->look_alikes =
        std::max(2, look_alikes(world.map, query.search.best_first(), world.options));
  return decision;
}

void Hypotheses::forget_robot(const Map& map, const std::string& robot) {
  pool_.forget_robot(map, robot);
  if (query_ && query_->robot == robot) query_.reset();
  const auto asks = [&](const PlaceQuery& query) { return query.robot == robot; };
  std::erase_if(queue_, asks);
  std::erase_if(late_, asks);
  std::erase_if(ready_, asks);
  for (PlaceQuery& query : asked_)
    if (asks(query)) query.newest_first.clear();
  ways_.erase(robot);
  for (auto& [name, way] : ways_) way.answers.forget_robot(map, robot);
}

}  // namespace isthmus
