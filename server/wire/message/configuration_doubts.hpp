#pragma once

#include <string>
#include <vector>

#include "server/engine/input/configuration.hpp"

namespace isthmus {

/// What may be meant otherwise in a configuration that is right, each a sentence: starts that are measured
/// from a robot which the configuration does not name, and which must introduce itself then.
std::vector<std::string> configuration_doubts(const Configuration& configuration);

}  // namespace isthmus
