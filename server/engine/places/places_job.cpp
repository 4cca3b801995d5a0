#include "server/engine/places/places_job.hpp"

#include <utility>

namespace isthmus {
PlacesJob::PlacesJob(const Map& map, std::vector<PlaceQuestion> questions, std::int64_t now_utime,
                     const PlaceCandidateOptions& options)
    : due_utime_(now_utime + static_cast<std::int64_t>(map.manifold().size()) * options.us_per_patch) {
  places_ = std::async(std::launch::async, [map, questions = std::move(questions), options] {
    Places places;
    for (const PlaceQuestion& question : questions)
      places.push_back(places_on_own_island(map, question.patch, question.hints, options));
    return places;
  });
}

}  // namespace isthmus
