#pragma once

#include <memory>
#include <set>
#include <tuple>

#include "server/engine/map/fit_job.hpp"

namespace isthmus {

/// Whole-island fits of the map itself, one at a time and each a job in another thread: after a loop or a
/// merge, when windows around robots no longer suffice, and where operators ask for it.
class IslandFits {
 public:
  void request(IslandId island) { requested_.insert(island); }
  /// Islands have merged or parted: a running fit is of a map that no longer exists.
  void map_changed();

  void advance(Map& map, std::int64_t now_utime, const MapFitOptions& options);
  bool busy() const { return job_ != nullptr || !requested_.empty(); }

  auto members() { return std::tie(requested_, job_, abandoned_); }

 private:
  std::set<IslandId> requested_;  ///< any patch of the island names it
  std::unique_ptr<FitJob> job_;
  AbandonedFits abandoned_;
};

}  // namespace isthmus
