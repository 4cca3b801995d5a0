#pragma once

#include <string>

#include "isthmus/status_t.hpp"

namespace isthmus {

/// The counters of ISTHMUS_STATUS in Prometheus' text format (version 0.0.4).
std::string metrics_text(const status_t& status);

constexpr const char* metrics_content_type = "text/plain; version=0.0.4";

}  // namespace isthmus
