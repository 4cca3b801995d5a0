#pragma once

#include <cstdint>

#include "server/engine/input/words.hpp"

namespace isthmus {

/// Why a sighting or a closure is accepted, refused or waits. server/README.md explains those that
/// sightings.csv shows.
enum class Reason : std::uint8_t {
  none,  ///< nothing is to be said, or not yet
  // Of a sighting that is not placed on the manifold.
  not_placed_yet,
  unknown_robot,
  sees_itself,
  unknown_barcode,
  before_first_scan,
  stamp_in_future,
  no_pose_at_stamp,
  // Of one that is.
  agrees_with_map,
  contradicts_map,
  unsupported,
  placed_tag,
  another_tag_is_there,
  robot_dropped,
  merged_islands,
  closed_loop,
  // Of a closure, and of the sightings that speak for it.
  on_trial,
  from_scans,
  measured_start,
  no_relation,
  too_little_support,
  map_changed,
  rested_on_another,
  contradicted,
  met_nobody,
  forbidden,
  allowed_again,
  // By its trial.
  fit_failed,
  implausible_jump,
  sightings_disagree,
  finds_disagree,
  walls_in_free_space,
  scans_disagree,
  one_corridor,
  nothing_beyond_the_seam,
};

template <>
inline constexpr auto words_of<Reason> = std::to_array<std::string_view>({
    "",
    "not_placed_yet",
    "unknown_robot",
    "sees_itself",
    "unknown_barcode",
    "before_first_scan",
    "stamp_in_future",
    "no_pose_at_stamp",
    "agrees_with_map",
    "contradicts_map",
    "unsupported",
    "placed_tag",
    "another_tag_is_there",
    "robot_dropped",
    "merged_islands",
    "closed_loop",
    "on_trial",
    "from_scans",
    "measured_start",
    "no_relation",
    "too_little_support",
    "map_changed",
    "rested_on_another",
    "contradicted",
    "met_nobody",
    "forbidden",
    "allowed_again",
    "fit_failed",
    "implausible_jump",
    "sightings_disagree",
    "finds_disagree",
    "walls_in_free_space",
    "scans_disagree",
    "one_corridor",
    "nothing_beyond_the_seam",
});
static_assert(has_word(Reason::nothing_beyond_the_seam) &&
              word(Reason::nothing_beyond_the_seam) == words_of<Reason>.back());

/// Whether sightings were tried out on the map and did not fit it.
constexpr bool is_refusal_by_trial(Reason reason) {
  return reason == Reason::implausible_jump || reason == Reason::sightings_disagree ||
         reason == Reason::walls_in_free_space || reason == Reason::scans_disagree;
}

}  // namespace isthmus
