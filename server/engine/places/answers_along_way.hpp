#pragma once

#include <deque>
#include <optional>
#include <tuple>
#include <vector>

#include "server/engine/places/place_search.hpp"

namespace isthmus {

/// A piece of a robot's way that was searched for, and all that it fits.
struct SearchedPiece {
  PatchId newest;
  double at_m = 0;  ///< along the robot's way
  std::vector<PlaceAnswer> best_first;

  auto members() { return std::tie(newest, at_m, best_first); }
};

/// What the searches along a robot's way came to. In a building that repeats itself one piece of way fits two
/// places about as well, but where the robot really is, the pieces before it fit too.
class AnswersAlongWay {
 public:
  /// The answers of the newest piece.
  void add(SearchedPiece piece, const AnswersAlongWayOptions& options);

  /// Of the newest piece's answers the one that the whole way makes all but certain. Against the
  /// likeliest other answer speaks how much better the pieces fit where the one has them than where the other
  /// has them; against ground that only looks alike, how many of them fit there at all since the robot may
  /// have come.
  std::optional<PlaceAnswer> all_but_certain(const Map& map, const EngineOptions& options) const;

  /// A robot's data is taken out: its patches are no places any more.
  void forget_robot(const Map& map, const std::string& robot);

  auto members() { return std::tie(pieces_); }

 private:
  std::deque<SearchedPiece> pieces_;  ///< the newest last
};

}  // namespace isthmus
