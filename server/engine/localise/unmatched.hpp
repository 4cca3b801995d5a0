#pragma once

#include <algorithm>
#include <cstdint>

#include "server/engine/input/words.hpp"

namespace isthmus {

/// Why a scan was not matched: the robot's pose is what odometry says, if anything. In the order of their
/// words, which is that of counters in all that is written.
enum class Unmatched : std::uint8_t {
  no,             ///< it was matched
  few_pairs,      ///< too few of its points have a partner on the local map
  few_returns,    ///< it has too few points to be matched with anything
  low_score,      ///< it fits the local map badly
  no_overlap,     ///< no local map, or the robot has lost its way so far that one scan tells none
  not_found_yet,  ///< nothing tells where on a finished map the robot is
};

template <>
inline constexpr auto words_of<Unmatched> = std::to_array<std::string_view>({
    "",
    "few_pairs",
    "few_returns",
    "low_score",
    "no_overlap",
    "not_found_yet",
});
static_assert(has_word(Unmatched::not_found_yet) &&
              word(Unmatched::not_found_yet) == words_of<Unmatched>.back());
static_assert(std::ranges::is_sorted(words_of<Unmatched>));

}  // namespace isthmus
