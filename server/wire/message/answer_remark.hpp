#pragma once

namespace isthmus {

/// answer_t.reason of a closure that is forbidden before anything proposes it: it is done.
constexpr const char* not_proposed_yet = "not_proposed_yet";

}  // namespace isthmus
