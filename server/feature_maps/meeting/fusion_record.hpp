#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "patches/pose.hpp"
#include "server/engine/input/words.hpp"

namespace isthmus {

enum class FusionState : std::uint8_t {
  waiting,   ///< not probable enough yet
  accepted,  ///< the maps are one
  withdrawn  ///< it must not be: an operator says so, or it was contradicted
};

template <>
inline constexpr auto words_of<FusionState> = std::to_array<std::string_view>({"waiting", "accepted",
                                                                               "withdrawn"});

/// Ids from this one on are of fusions by walls alone.
constexpr std::int32_t first_by_walls = 1'000'000'000;

/// Which placing of two maps by their walls it is: one journey's beginning seen from another's, one of
/// either map.
struct WallPlacing {
  int journey_1 = 0;
  int journey_2 = 0;
  Pose start_1_from_start_2;

  auto members() { return std::tie(journey_1, journey_2, start_1_from_start_2); }
};

/// That two maps are one, with its account.
struct FusionRecord {
  std::int32_t id = -1;  ///< of the first sighting that speaks for it, its number; of the first scan,
                         ///< `first_by_walls` and its number: the same whatever is forbidden
  FusionState state = FusionState::waiting;
  std::int64_t utime = 0;           ///< of what last spoke for it
  std::vector<std::string> robots;  ///< of what speaks for it
  std::vector<int> side_1, side_2;  ///< journeys of either map, once made
  double clues_log_odds = 0;        ///< by sightings and tags
  double twins_log_odds = 0;        ///< by what the maps have in common
  double since_log_odds = 0;        ///< by encounters afterwards
  std::size_t clues = 0;
  std::size_t duplicates = 0;
  std::optional<WallPlacing> placing;  ///< if it is by walls alone

  auto members() {
    return std::tie(id, state, utime, robots, side_1, side_2, clues_log_odds, twins_log_odds, since_log_odds,
                    clues, duplicates, placing);
  }

  /// Whether two journeys are on one map by it.
  bool brought_together(int one, int other) const {
    const auto lies_on = [](const std::vector<int>& side, int journey) {
      return std::find(side.begin(), side.end(), journey) != side.end();
    };
    return state == FusionState::accepted && ((lies_on(side_1, one) && lies_on(side_2, other)) ||
                                              (lies_on(side_2, one) && lies_on(side_1, other)));
  }

  double log_odds() const { return clues_log_odds + twins_log_odds + since_log_odds; }
};

}  // namespace isthmus
