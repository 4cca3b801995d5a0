#pragma once

#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "server/engine/places/place_candidates.hpp"
#include "server/engine/places/place_search.hpp"

namespace isthmus {

/// On what terms a piece of way is searched for: those who search differ in them.
struct SearchTerms {
  double min_score = 0;           ///< of an answer at a place that the map says something of
  double min_score_anywhere = 0;  ///< and at one of which it says nothing
  double min_carrier_score = 0;   ///< of the scan that carries the relations
  /// A window that is too much for one step is searched in halves of its yaw, down to this; π: it is not.
  double min_half_window_rad = std::numbers::pi;
  bool on_the_map =
      false;  ///< the piece is of the map itself: it is looked for among what it was not matched with
};

/// What the answers at all places come to.
struct PlaceDecision {
  bool ambiguous = false;    ///< two places fit about as well
  std::optional<Find> find;  ///< the one place, where a scan matches there, however well
  std::int64_t price_us = 0;
};

/// Searches for a piece of a robot's way at one place after the other, in bounded steps, and decides whether
/// it fits in one place only.
class PlaceSearcher {
 public:
  PlaceSearcher() = default;
  explicit PlaceSearcher(std::vector<PlaceCandidate> places) : places_(std::move(places)) {}

  void add(std::vector<PlaceCandidate> places);
  void look_for(RigidPiece piece) { piece_ = std::move(piece); }

  const RigidPiece& piece() const { return piece_; }
  bool has_places() const { return !places_.empty(); }
  /// The place whose turn it is; none: all that is left is to decide.
  const PlaceCandidate* next() const { return next_ < places_.size() ? &places_[next_] : nullptr; }
  /// Searches there; `place`: what lies around its anchor. Returns the price, in nominal microseconds.
  std::int64_t search_next(const RigidPiece& place, const SearchTerms& terms, const EngineOptions& options);
  /// All that was found.
  const std::vector<PlaceAnswer>& best_first();
  PlaceDecision decide(const Map& map, const SearchTerms& terms, const EngineOptions& options);
  /// Where something else tells which answer it is.
  PlaceDecision decide_on(const PlaceAnswer& answer, const Map& map, const SearchTerms& terms,
                          const EngineOptions& options) const;

  auto members() { return std::tie(piece_, places_, next_, answers_, best_score_, exhausted_); }

 private:
  void search_halves(const PlaceCandidate& place, double min_half_window_rad);

  RigidPiece piece_;
  std::vector<PlaceCandidate> places_;
  std::size_t next_ = 0;
  std::vector<PlaceAnswer> answers_;
  double best_score_ = 0;
  bool exhausted_ = false;  ///< some window was too much: what was found there need not be the best
};

}  // namespace isthmus
