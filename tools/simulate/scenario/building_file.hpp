#pragma once

#include <utility>

#include "tools/simulate/plan/clutter.hpp"
#include "tools/simulate/scenario/scenario_settings.hpp"

namespace isthmus {

/// A building and what is to be strewn over it, from a scenario's `building` table or a building's own file.
/// Throws std::runtime_error naming file, line and reason.
std::pair<Building, Clutter> read_building(const Setting& setting);

}  // namespace isthmus
