#pragma once

#include <cstdint>
#include <future>
#include <tuple>
#include <vector>

#include "server/engine/places/place_candidates.hpp"

namespace isthmus {

/// A patch whose place is asked for, with what waiting finds say of it.
struct PlaceQuestion {
  PatchId patch;
  std::vector<PlaceHint> hints;
};

/// Looks up where some patches may lie on their own islands, on a copy of the map and in a thread of its own:
/// what `places_on_own_island` asks of a whole island takes longer the larger it is. Begun at one event, and
/// applied at a later one that a rule decides (3 ms a patch after it, so that it is hardly ever late). Who
/// asks earlier waits.
class PlacesJob {
 public:
  using Places = std::vector<std::vector<PlaceCandidate>>;  ///< by question

  PlacesJob() = default;  ///< to be read from a snapshot
  PlacesJob(const Map& map, std::vector<PlaceQuestion> questions, std::int64_t now_utime,
            const PlaceCandidateOptions& options);

  bool is_due(std::int64_t now_utime) const { return now_utime >= due_utime_; }
  /// Waits for the result where it is late.
  const Places& places() const { return places_.get(); }

  auto members() { return std::tie(due_utime_, places_); }

 private:
  std::int64_t due_utime_ = 0;
  std::shared_future<Places> places_;
};

}  // namespace isthmus
