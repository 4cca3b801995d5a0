#include "server/wire/message/reason_sentence.hpp"

#include <span>

#include "server/wire/message/answer_remark.hpp"

namespace isthmus {
namespace {

struct Meaning {
  std::string_view reason;
  std::string_view sentence;
};

constexpr Meaning of_both[] = {
    {"unsigned", "this server takes signed messages only"},
    {"no_keys", "this server has no keys: send it unsigned"},
    {"unknown_sender", "the server knows no such operator"},
    {"forged", "the key is another than the server's"},
    {"replayed", "one with a later time has been taken already"},
    {"stopped", "the server stops"},
    {"queue_full", "too much waits to be answered: ask again later"},
    {"bad_name",
     "a name has 1 to 48 letters, digits, spaces, '.', '_' and '-', and begins and ends with a "
     "letter or digit"},
    {"unknown_robot", "there is no such robot"},
};

constexpr Meaning of_orders[] = {
    {"not_accepted", "it is not accepted (any more)"},
    {"no_such_closure", "there is no such closure"},
    {"not_forbidden", "it is not forbidden (any more)"},
    {"not_dropped", "the robot is not dropped"},
    {"frozen", "the map is frozen"},
    {"journal_full", "the disk is full"},
    {"bad_polygon", "its sides cross or touch, or it has no area"},
    {"name_taken", "another place or zone has this name"},
    {"no_such_name", "there is none of this name (any more)"},
    {"off_the_map", "it is too far from everything that is mapped"},
    {"other_island", "its corners are on several islands"},
    {"unknown_patch", "the map has changed meanwhile: draw it again"},
    {"no_manifold", "the server makes maps of features, which have no patches for this"},
    {"too_many_annotations", "there are as many places and zones as there may be"},
    {"not_finished", "robots are placed on finished maps only (--frozen)"},
    {"absurd_value", "a number is none that can be"},
    {"not_finite", "a number is infinite or none"},
    {not_proposed_yet, "nothing like it is known yet; it is forbidden should it be proposed"},
};

constexpr Meaning of_questions[] = {
    {"bad_kind", "the server knows no such question or target"},
    {"bad_value", "a number is none that can be"},
    {"unknown_patch", "no such patch is on the map"},
    {"unknown_robot", "it has not been heard since the server's start, or has nothing on that island"},
    {"unknown_tag", "no such tag is on the map"},
    {"unknown_place", "no place of that name is on the map"},
    {"other_island", "the two are on islands of which nobody knows how they lie"},
    {"kept_out", "the start or the end lies in a keep-out zone, or there is no way but through one"},
    {"no_ground", "nothing is known of the ground there"},
    {"no_room", "the robot fits nowhere near the start or the end"},
    {"unreachable", "there is no way over known ground"},
    {"too_long", "the way is of more poses than an answer holds"},
    {"undetermined", "the map's relations do not tell how the two lie"},
    {"too_many_followed", "as many paths are followed as may be"},
    {"timed_out", "the server had no time for it: ask again, or with a longer --timeout"},
    {"failed", "a fault of the server: its log says more"},
};

std::string_view look_up(std::span<const Meaning> meanings, std::string_view reason) {
  for (const Meaning& meaning : meanings)
    if (meaning.reason == reason) return meaning.sentence;
  return {};
}

}  // namespace

std::string_view sentence_of_order(std::string_view reason) {
  const std::string_view sentence = look_up(of_orders, reason);
  return sentence.empty() ? look_up(of_both, reason) : sentence;
}

std::string_view sentence_of_question(std::string_view reason) {
  const std::string_view sentence = look_up(of_questions, reason);
  return sentence.empty() ? look_up(of_both, reason) : sentence;
}

std::string with_sentence(std::string_view reason, std::string_view sentence) {
  std::string text(reason);
  if (!sentence.empty()) text.append(": ").append(sentence);
  return text;
}

}  // namespace isthmus
