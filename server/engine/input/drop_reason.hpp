#pragma once

#include <algorithm>
#include <cstdint>

#include "server/engine/input/words.hpp"

namespace isthmus {

/// Why a message is dropped, by the engine or before it is an event. lcmtypes/README.md explains each. In the
/// order of their words, which is that of counters in all that is written.
enum class DropReason : std::uint8_t {
  none,  ///< it is not
  absurd_value,
  bad_channel,
  bad_configuration,
  bad_fingerprint,
  bad_length,
  bad_name,
  barcode_taken,
  duplicate_stamp,
  foreign_channel,
  forged,
  fragments_lost,
  frozen,
  journal_full,
  late_configuration,
  malformed_packet,
  message_too_large,
  no_keys,
  no_laser,
  no_odometry,
  no_such_closure,
  not_accepted,
  not_dropped,
  not_finite,
  not_forbidden,
  queue_full,
  replayed,
  restarted,
  robot_dropped,
  sees_itself,
  set_aside,
  stale_stamp,
  stopped,
  too_many_fragments,
  too_many_patches,
  too_many_robots,
  too_many_tags,
  too_many_unfinished,
  unknown_barcode,
  unknown_command,
  unknown_robot,
  unknown_sender,
  not_signed,
  zero_beams,
};

template <>
inline constexpr auto words_of<DropReason> = std::to_array<std::string_view>({
    "",
    "absurd_value",
    "bad_channel",
    "bad_configuration",
    "bad_fingerprint",
    "bad_length",
    "bad_name",
    "barcode_taken",
    "duplicate_stamp",
    "foreign_channel",
    "forged",
    "fragments_lost",
    "frozen",
    "journal_full",
    "late_configuration",
    "malformed_packet",
    "message_too_large",
    "no_keys",
    "no_laser",
    "no_odometry",
    "no_such_closure",
    "not_accepted",
    "not_dropped",
    "not_finite",
    "not_forbidden",
    "queue_full",
    "replayed",
    "restarted",
    "robot_dropped",
    "sees_itself",
    "set_aside",
    "stale_stamp",
    "stopped",
    "too_many_fragments",
    "too_many_patches",
    "too_many_robots",
    "too_many_tags",
    "too_many_unfinished",
    "unknown_barcode",
    "unknown_command",
    "unknown_robot",
    "unknown_sender",
    "unsigned",
    "zero_beams",
});
static_assert(has_word(DropReason::zero_beams) &&
              word(DropReason::zero_beams) == words_of<DropReason>.back());
static_assert(std::ranges::is_sorted(words_of<DropReason>));

}  // namespace isthmus
