#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "isthmus/request_t.hpp"
#include "server/engine/input/words.hpp"
#include "server/paths/questions/told_path.hpp"

namespace isthmus {

/// What robots ask of the map on ISTHMUS_REQUEST.
enum class QuestionKind : std::uint8_t {
  path,
  retro_traverse,
  relative_pose,
  frontiers,
  map_version,
  changes,
};
template <>
inline constexpr auto words_of<QuestionKind> = std::to_array<std::string_view>({"path", "retro_traverse",
                                                                                "relative_pose", "frontiers",
                                                                                "map_version", "changes"});

/// Where to, or of what the relative pose. Home is where the robot's first patch of its island begins.
enum class Target : std::uint8_t { pose, patch, tag, place, robot, home };
template <>
inline constexpr auto words_of<Target> = std::to_array<std::string_view>({"pose", "patch", "tag", "place",
                                                                          "robot", "home"});

/// Why a question was not let in, or nobody looked at it; those of the map itself are `Refusal`s.
enum class QuestionRefusal : std::uint8_t {
  none,
  bad_bytes,          ///< not a request_t, or its counts are out of bounds
  bad_name,           ///< no asker, or the robot's name can be none
  bad_value,          ///< a number that is not finite or beyond what is possible
  bad_kind,           ///< no such kind of question, or of target
  queue_full,         ///< too many wait, of this asker or of all
  timed_out,          ///< it waited, or took, longer than the asker does
  too_many_followed,  ///< paths, of this asker or of all
  stopped,            ///< the server is stopping
  failed,             ///< the server could not: a fault of its own
};
template <>
inline constexpr auto words_of<QuestionRefusal> =
    std::to_array<std::string_view>({"", "bad_bytes", "bad_name", "bad_value", "bad_kind", "queue_full",
                                     "timed_out", "too_many_followed", "stopped", "failed"});

template <>
inline constexpr auto words_of<PathChange> = std::to_array<std::string_view>({"", "moved", "blocked",
                                                                              "opened", "shortened",
                                                                              "target_moved", "arrived"});

/// Why a path that is followed is followed no more, besides that the robot has arrived.
enum class FollowEnd : std::uint8_t {
  expired,   ///< the time that was asked for is over
  replaced,  ///< who asked has asked again with the same id
  stopped,   ///< the server is stopping
};
template <>
inline constexpr auto words_of<FollowEnd> = std::to_array<std::string_view>({"expired", "replaced",
                                                                             "stopped"});

/// A question whose values were checked. Robots' names are in upper case.
struct Question {
  request_t request;
  QuestionKind kind = QuestionKind::map_version;
  Target target = Target::pose;  ///< of path and relative_pose
};

/// The longest that anybody may wait, in seconds.
inline constexpr double max_question_timeout_s = 60;
/// The longest that a path is followed, in seconds.
inline constexpr double max_follow_s = 3600;

/// What the bytes say; nothing where they are not safe to decode.
std::optional<request_t> read_request(std::span<const std::uint8_t> bytes);

/// Checks the values that the kind of question uses.
struct QuestionReading {
  std::optional<Question> question;
  QuestionRefusal refusal = QuestionRefusal::none;
};
QuestionReading read_question(request_t request);

/// What is asked in a message on whatever channel, in an envelope or without, whether or not it is believed;
/// nothing where it is no question.
std::optional<request_t> request_in(const std::string& channel, std::span<const std::uint8_t> bytes);

}  // namespace isthmus
