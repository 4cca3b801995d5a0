#pragma once

#include <string>

#include "tools/replay/replay.hpp"

namespace isthmus {

/// The map of a snapshot; of a journal's directory, by its newest snapshot and what came after it; or of a
/// log, replayed. With a configuration file of its own every event is replayed. Throws std::runtime_error
/// naming the file and the reason.
ReplayResult read_map(const std::string& path, const ReplayOptions& options);

}  // namespace isthmus
