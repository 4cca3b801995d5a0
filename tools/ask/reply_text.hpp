#pragma once

#include <string>

#include "isthmus/reply_t.hpp"

namespace isthmus {

/// What is known of a done reply, as lines of CSV with a header; metres and radians.
std::string to_text(const reply_t& reply);

/// The same of a path that is followed, and why there is none, after a line of what changed.
std::string update_text(const reply_t& reply);

}  // namespace isthmus
