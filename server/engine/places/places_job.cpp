#include "server/engine/places/places_job.hpp"

#include <utility>

namespace isthmus {
PlacesJob::PlacesJob(const Map& map, std::vector<PatchId> patches, std::int64_t now_utime,
                     const PlaceCandidateOptions& options)
    : due_utime_(now_utime + static_cast<std::int64_t>(map.manifold().size()) * options.us_per_patch) {
  places_ = std::async(std::launch::async, [map, patches = std::move(patches), options] {
    Places places;
    for (const PatchId patch : patches) places.push_back(places_on_own_island(map, patch, options));
    return places;
  });
}

}  // namespace isthmus
