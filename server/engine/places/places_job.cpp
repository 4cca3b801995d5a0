#include "server/engine/places/places_job.hpp"

#include <iterator>
#include <map>
#include <utility>

#include "server/engine/places/place_survey.hpp"

namespace isthmus {
namespace {

/// One factorisation an island, whatever is asked of it.
using Covariances = std::map<IslandId, IslandCovariances>;

std::vector<PlaceCandidate> places_for(const PlaceQuestion& question, const Map& map,
                                       Covariances& covariances, const PlaceCandidateOptions& options) {
  const PatchId newest = question.newest_first.front();
  const IslandId own = map.graph().island(newest);
  const IslandCovariances& island =
      covariances.try_emplace(own, map.graph(), map.manifold().poses(), own).first->second;
  std::vector<PlaceCandidate> places = places_on_own_island(map, question, island, options);
  if (!question.on_other_islands) return places;
  std::vector<PlaceCandidate> others = places_on_other_islands(map, newest, question.hints, options);
  if (question.in_turn) others = places_on_islands_in_turn(map, newest, others, options);
  std::ranges::move(others, std::back_inserter(places));
  return places;
}

}  // namespace

PlacesJob::PlacesJob(const Map& map, std::vector<PlaceQuestion> questions, std::int64_t now_utime,
                     const EngineOptions& options, double min_score_elsewhere)
    : due_utime_(now_utime +
                 static_cast<std::int64_t>(map.manifold().size()) * options.place_candidates.us_per_patch) {
  places_ =
      std::async(std::launch::async, [map, questions = std::move(questions), options, min_score_elsewhere] {
        Places places;
        std::vector<RigidPiece> pieces;
        Covariances covariances;
        for (const PlaceQuestion& question : questions) {
          places.push_back(places_for(question, map, covariances, options.place_candidates));
          pieces.push_back(piece_of_way(map, question.newest_first, options.place_search));
        }
        leave_possible(places, pieces, map, min_score_elsewhere, options);
        return places;
      });
}

}  // namespace isthmus
