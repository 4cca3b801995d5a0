#pragma once

#include <cstdint>
#include <future>
#include <memory>
#include <tuple>
#include <vector>

#include "server/engine/input/engine_options.hpp"
#include "server/engine/places/look_up_tables.hpp"
#include "server/engine/places/place_candidates.hpp"

namespace isthmus {

/// Looks up where some pieces of way may lie, on a copy of the map and in a thread of its own: what
/// `places_on_own_island` asks of a whole island takes longer the larger it is, and so does the survey by
/// which places of other islands are left out where a piece cannot lie with a score. Begun at one event, and
/// applied at a later one that a rule decides (3 ms a patch after it, so that it is hardly ever late). Who
/// asks earlier waits. The tables are the map's, and nobody else's meanwhile.
class PlacesJob {
 public:
  using Places = std::vector<std::vector<PlaceCandidate>>;  ///< by question: own island first

  PlacesJob() = default;  ///< to be read from a snapshot
  PlacesJob(const Map& map, std::vector<PlaceQuestion> questions, std::int64_t now_utime,
            const EngineOptions& options, double min_score_elsewhere,
            std::shared_ptr<LookUpTables> tables = std::make_shared<LookUpTables>());

  bool is_due(std::int64_t now_utime) const { return now_utime >= due_utime_; }
  /// Waits for the result where it is late.
  const Places& places() const { return places_.get(); }

  auto members() { return std::tie(due_utime_, places_); }

 private:
  std::int64_t due_utime_ = 0;
  std::shared_future<Places> places_;
};

}  // namespace isthmus
