#pragma once

#include <cstdint>
#include <future>
#include <set>
#include <tuple>
#include <vector>

#include "server/engine/closures/joining.hpp"
#include "server/engine/input/engine_options.hpp"
#include "server/engine/map/map.hpp"

namespace isthmus {

/// Two maps laid over one another.
struct Overlay {
  double matched_m = 0;    ///< way on which they match,
  double unmatched_m = 0;  ///< and on which they do not, although both know the ground
  double width_m = 0;      ///< of what matches, across its length

  auto members() { return std::tie(matched_m, unmatched_m, width_m); }
};

/// What a map would be without a merge and all that depends on it.
struct Parting {
  ClosureId merge;
  std::vector<IslandId> islands;  ///< of each patch that the map had, by id
  Overlay overlay;                ///< of the two islands that the merge holds together, if it was asked for

  /// Whether it has two patches on two islands. One that came since is where its first relation ties it.
  bool has_apart(const RelationGraph& graph, PatchId a, PatchId b) const;

  auto members() { return std::tie(merge, islands, overlay); }
};

/// Of a joining that the map contradicts: which of some merges have its ends on one island, that would be on
/// two without?
struct PartingQuestion {
  Joining joining;
  std::set<ClosureId> merges;
  bool only_elsewhere = false;  ///< of none, where drift explains how its ends lie
  bool with_overlay = false;
};

std::vector<Parting> partings(const Map& map, const PartingQuestion& question, const EngineOptions& options);

/// The same on a copy of the map and in a thread of its own, as it takes longer the larger the map is: begun
/// at one event, and applied at a later one that a rule decides (`place_candidates.us_per_patch` a patch
/// after it, so that it is hardly ever late). Who asks earlier waits.
class PartingsJob {
 public:
  PartingsJob() = default;  ///< to be read from a snapshot
  PartingsJob(const Map& map, PartingQuestion question, std::int64_t now_utime, const EngineOptions& options);

  bool is_due(std::int64_t now_utime) const { return now_utime >= due_utime_; }
  /// Waits for the result where it is late.
  const std::vector<Parting>& partings() const { return partings_.get(); }

  auto members() { return std::tie(due_utime_, partings_); }

 private:
  std::int64_t due_utime_ = 0;
  std::shared_future<std::vector<Parting>> partings_;
};

}  // namespace isthmus
