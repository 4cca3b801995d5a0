#pragma once

#include "tools/simulate/wild/draw.hpp"

namespace isthmus {

/// The building of a draw, how it changes, and who drives in it where.
Scenario make_wild_scenario(const WildDraw& draw);

/// The run of a draw, with the faults of its wheels. `scenario` is the draw's.
SimulatedRun simulate_wild(const WildDraw& draw, const Scenario& scenario);

}  // namespace isthmus
