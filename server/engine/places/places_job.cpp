#include "server/engine/places/places_job.hpp"

#include <iterator>
#include <utility>

#include "server/engine/places/place_survey.hpp"

namespace isthmus {
namespace {

std::vector<PlaceCandidate> places_for(const PlaceQuestion& question, const Map& map, LookUpTables& tables,
                                       const PlaceCandidateOptions& options) {
  const PatchId newest = question.newest_first.front();
  const IslandId own = map.graph().island(newest);
  std::vector<PlaceCandidate> places =
      places_on_own_island(map, question, tables.network(map), tables.covariances(map, own), options);
  if (!question.on_other_islands) return places;
  std::vector<PlaceCandidate> others = places_on_other_islands(map, newest, question.hints, options);
  if (question.in_turn) others = places_on_islands_in_turn(map, newest, others, options);
  std::ranges::move(others, std::back_inserter(places));
  return places;
}

}  // namespace

PlacesJob::PlacesJob(const Map& map, std::vector<PlaceQuestion> questions, std::int64_t now_utime,
                     const EngineOptions& options, double min_score_elsewhere,
                     std::shared_ptr<LookUpTables> tables)
    : due_utime_(now_utime +
                 static_cast<std::int64_t>(map.manifold().size()) * options.place_candidates.us_per_patch) {
  places_ = std::async(std::launch::async, [map, questions = std::move(questions), options,
                                            min_score_elsewhere, tables = std::move(tables)] {
    Places places;
    std::vector<RigidPiece> pieces;
    for (const PlaceQuestion& question : questions) {
      places.push_back(places_for(question, map, *tables, options.place_candidates));
      pieces.push_back(piece_of_way(map, question.newest_first, options.place_search));
    }
    leave_possible(places, pieces, map, min_score_elsewhere, options);
    return places;
  });
}

}  // namespace isthmus
