#pragma once

#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

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

/// That two maps are one, with its account.
struct FusionRecord {
  std::int32_t id = -1;  ///< the number of the first input that speaks for it: the same whatever is forbidden
  FusionState state = FusionState::waiting;
  std::int64_t utime = 0;           ///< of what last spoke for it
  std::vector<std::string> robots;  ///< of what speaks for it
  std::vector<int> side_1, side_2;  ///< journeys of either map, once made
  double clues_log_odds = 0;        ///< by sightings and tags
  double twins_log_odds = 0;        ///< by what the maps have in common
  double since_log_odds = 0;        ///< by encounters afterwards
  std::size_t clues = 0;
  std::size_t duplicates = 0;

  auto members() {
    return std::tie(id, state, utime, robots, side_1, side_2, clues_log_odds, twins_log_odds, since_log_odds,
                    clues, duplicates);
  }

  double log_odds() const { return clues_log_odds + twins_log_odds + since_log_odds; }
};

}  // namespace isthmus
