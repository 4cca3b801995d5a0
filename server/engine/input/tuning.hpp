#pragma once

#include <string>

#include "server/engine/input/engine_options.hpp"
#include "server/engine/input/settings.hpp"

namespace isthmus {

/// Reads [tuning], a table of groups of values (`match.sigma_m = 0.03`). Throws SettingError for an unknown
/// key, one of the wrong type, and a number that is not finite, has another sign than its default, or is more
/// than a thousand times larger or smaller: that is a wrong unit, not an experiment. A share is 1 at most,
/// and a probability is between 0 and 1.
void read_tuning(const Setting& table, EngineOptions& options);

/// All values as such a table, each below a line "# UNIT: MEANING".
std::string tuning_text(EngineOptions options);

}  // namespace isthmus
