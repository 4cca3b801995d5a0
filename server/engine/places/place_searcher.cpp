#include "server/engine/places/place_searcher.hpp"

#include <algorithm>
#include <functional>
#include <iterator>
#include <utility>

namespace isthmus {
void PlaceSearcher::add(std::vector<PlaceCandidate> places) {
  std::ranges::move(places, std::back_inserter(places_));
}

std::int64_t PlaceSearcher::search_next(const RigidPiece& place, const SearchTerms& terms,
                                        const EngineOptions& options) {
  const PlaceCandidate candidate = places_[next_++];
  const double min_score = candidate.is_on_other_island() ? terms.min_score_anywhere : terms.min_score;
  const PlaceSearch search = search_place(
      place, piece_, candidate.window, std::max(min_score, options.ambiguity.share * best_score_), options);
  if (search.exhausted) search_halves(candidate, terms.min_half_window_rad);
  for (const PlaceAnswer& answer : search.answers) {
    best_score_ = std::max(best_score_, answer.score);
    answers_.push_back(answer);
    answers_.back().way_m = candidate.way_m;
    answers_.back().sigma_m = candidate.sigma_m;
  }
  const PlaceSearchOptions& its = options.place_search;
  return its.step_price_us +
         static_cast<std::int64_t>(its.evaluation_price_us * static_cast<double>(search.evaluations));
}

// What is too much for one step is done in two, once more is known of what is worth finding.
void PlaceSearcher::search_halves(const PlaceCandidate& place, double min_half_window_rad) {
  const double half = 0.5 * place.window.half_yaw_rad;
  if (half < min_half_window_rad) {
    exhausted_ = true;
    return;
  }
  for (const double yaw : {place.window.centre.yaw - half, place.window.centre.yaw + half}) {
    places_.push_back(place);
    places_.back().window.centre.yaw = wrap_angle(yaw);
    places_.back().window.half_yaw_rad = half;
  }
}

const std::vector<PlaceAnswer>& PlaceSearcher::best_first() {
  std::ranges::stable_sort(answers_, std::ranges::greater{}, &PlaceAnswer::score);
  return answers_;
}

PlaceDecision PlaceSearcher::decide(const Map& map, const SearchTerms& terms, const EngineOptions& options) {
  PlaceDecision decision;
  if (best_first().empty()) return decision;
  decision.ambiguous = exhausted_ || look_alikes(map, answers_, options) > 1;
  return decision.ambiguous ? decision : decide_on(answers_.front(), map, terms, options);
}

PlaceDecision PlaceSearcher::decide_on(const PlaceAnswer& answer, const Map& map, const SearchTerms& terms,
                                       const EngineOptions& options) const {
  PlaceDecision decision;
  const RigidPiece place = place_around(
      map, answer.anchor, terms.on_the_map ? own_part(map, piece_) : std::vector<PatchId>{}, options);
  // While the piece waited, all that is there may have been matched with it.
  if (place.local.patches.empty()) return decision;
  decision.find = refine(place, piece_, answer, terms.min_carrier_score, options);
  decision.price_us = options.propagation.step_price_us;  // as that, it matches two patches or more
  return decision;
}

}  // namespace isthmus
