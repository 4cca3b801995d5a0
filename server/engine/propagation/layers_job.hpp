#pragma once

#include <cstdint>
#include <future>
#include <tuple>
#include <vector>

#include "server/engine/input/options/map_options.hpp"
#include "server/engine/map/map.hpp"

namespace isthmus {

/// How many pairs of an island's patches contradict one another as the map was before a change and as it is
/// with it: a place that was drawn twice, and is drawn once by the change, or the other way round. On copies,
/// in a thread of its own: begun at one event, and applied at a later one that a rule decides
/// (`us_per_patch` after it, so that it is hardly ever late). Who asks earlier waits.
class LayersJob {
 public:
  struct Pairs {
    int before = 0;
    int after = 0;

    auto members() { return std::tie(before, after); }
  };

  LayersJob() = default;  ///< to be read from a snapshot
  LayersJob(const Map& map, IslandId island, RelationGraph graph_before, std::vector<Pose> poses_before,
            std::int64_t now_utime, const MapFitOptions& options);

  bool is_due(std::int64_t now_utime) const { return now_utime >= due_utime_; }
  /// Waits for the result where it is late.
  const Pairs& pairs() const { return pairs_.get(); }

  auto members() { return std::tie(due_utime_, pairs_); }

 private:
  std::int64_t due_utime_ = 0;
  std::shared_future<Pairs> pairs_;
};

}  // namespace isthmus
