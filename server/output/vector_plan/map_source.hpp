#pragma once

#include "server/engine/record/map_copy.hpp"
#include "server/output/vector_plan/plan_options.hpp"
#include "server/output/vector_plan/plan_source.hpp"

namespace isthmus {

/// What the patches of one island show of walls and poles, each where its patch now lies. Patches that
/// operators have left out show nothing.
PlanSource plan_source(const MapCopy& map, const std::vector<PatchId>& island_patches,
                       const PatchErrorOptions& options);

}  // namespace isthmus
