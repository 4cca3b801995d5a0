#include "server/paths/questions/path.hpp"

namespace isthmus {

std::string_view word(Refusal refusal) {
  switch (refusal) {
    case Refusal::none:
      return "none";
    case Refusal::bad_value:
      return "bad_value";
    case Refusal::unknown_patch:
      return "unknown_patch";
    case Refusal::unknown_robot:
      return "unknown_robot";
    case Refusal::unknown_tag:
      return "unknown_tag";
    case Refusal::unknown_place:
      return "unknown_place";
    case Refusal::other_island:
      return "other_island";
    case Refusal::no_ground:
      return "no_ground";
    case Refusal::kept_out:
      return "kept_out";
    case Refusal::no_room:
      return "no_room";
    case Refusal::unreachable:
      return "unreachable";
    case Refusal::too_long:
      return "too_long";
    case Refusal::undetermined:
      return "undetermined";
  }
  return "";
}

}  // namespace isthmus
