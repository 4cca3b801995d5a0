#pragma once

#include <vector>

#include "tools/simulate/run/unicycle.hpp"

namespace isthmus {

/// Delays robots so that no two touch: each waits for those before it in the list, as early on its way as it
/// must. One that is carried, or that would have to wait for more than 200 s, drives as it came.
void give_way(std::vector<TruePath>& paths, const std::vector<double>& radii_m);

}  // namespace isthmus
