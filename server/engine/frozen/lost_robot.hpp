#pragma once

#include <cstdint>
#include <string>

#include "server/engine/input/words.hpp"

namespace isthmus {

/// Why a robot on a finished map is not found yet.
enum class NotFound : std::uint8_t {
  way_too_short,         ///< what lies on so short a way would fit in many places
  searching,             ///< all over the map
  fits_nowhere,          ///< what lies on its way is nowhere on the map
  ambiguous,             ///< it fits two places about as well
  found_once,            ///< another piece of the way must say the same
  trying_a_place,        ///< scans are matched where it may be
  given_pose_misfits,    ///< its scans do not fit where somebody says that it is
  given_pose_ambiguous,  ///< there they fit two places about as well, or too many were to be searched
};

template <>
inline constexpr auto words_of<NotFound> = std::to_array<std::string_view>({
    "way_too_short",
    "searching",
    "fits_nowhere",
    "ambiguous",
    "found_once",
    "trying_a_place",
    "given_pose_misfits",
    "given_pose_ambiguous",
});
static_assert(words_of<NotFound>.size() == static_cast<std::size_t>(NotFound::given_pose_ambiguous) + 1);

/// A robot that gets no pose, or one that is elsewhere than somebody says.
struct LostRobot {
  std::string robot;
  NotFound why = NotFound::searching;
  double way_m = 0;      ///< that it is looked for by
  double min_way_m = 0;  ///< that a search takes
  bool placed = false;   ///< it stays where it was found
};

}  // namespace isthmus
