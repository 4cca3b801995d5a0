#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace isthmus {

/// Removes what an earlier export into the same directory wrote and this one did not: grids of islands that
/// have merged since, trajectories of robots that are not on this map. Nothing else is touched.
void remove_stale(const std::string& directory, std::size_t islands, const std::vector<std::string>& robots);

}  // namespace isthmus
