#pragma once

#include <string>
#include <vector>

#include "tools/simulate/scenario/scenario.hpp"

namespace isthmus {

/// Reads a scenario by name (of the scenarios that come with Isthmus) or by file. `overrides` are
/// "key.path=value", laid over what the file says. Throws UsageError where none has that name, and where an
/// override is wrong; std::runtime_error naming file, line and reason: of unknown keys, wrong types, and
/// tours that come too near a wall.
Scenario load_scenario(const std::string& name_or_file, const std::vector<std::string>& overrides = {});

struct ScenarioSummary {
  std::string name;
  std::string summary;
};
/// The scenarios that come with Isthmus, by name.
std::vector<ScenarioSummary> list_scenarios();

}  // namespace isthmus
