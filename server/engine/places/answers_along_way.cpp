#include "server/engine/places/answers_along_way.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "server/engine/places/place_candidates.hpp"

namespace isthmus {
namespace {

/// A place that a piece of way may have been found at: where on which island.
struct Whereabouts {
  IslandId island;
  Pose island_from_piece;
};

Whereabouts whereabouts(const Map& map, const PlaceAnswer& answer) {
  return {map.graph().island(answer.anchor), map.manifold().pose(answer.anchor) * answer.anchor_from_piece};
}

/// One answer of the newest piece, taken for true, and what the pieces before it say.
struct Hypothesis {
  Whereabouts at;
  std::vector<double> fits;  ///< by piece, newest first: as a share of its best answer's; 0: not found there
};

// Whether a piece may lie there, for what a map errs by over so much way.
bool same_place(const Whereabouts& found, const Whereabouts& there, double way_m,
                const EngineOptions& options) {
  if (found.island != there.island) return false;
  const Pose off = ominus(found.island_from_piece, there.island_from_piece);
  const Eigen::Vector3d systematic = systematic_variance(way_m, options.place_candidates);
  const double position = std::pow(options.consistency.find_sigma_m, 2) + systematic.x();
  const double yaw = std::pow(options.common.yaw_rad(options.consistency.find_sigma_m), 2) + systematic.z();
  return (off.x * off.x + off.y * off.y) / position + off.yaw * off.yaw / yaw <
         options.common.plausible.bound(3);
}

double fit_there(const Map& map, const SearchedPiece& piece, const Whereabouts& there, double way_m,
                 const EngineOptions& options) {
  for (const PlaceAnswer& answer : piece.best_first)
    if (same_place(whereabouts(map, answer), there, way_m, options))
      return answer.score / piece.best_first.front().score;
  return 0;
}

Hypothesis hypothesis_of(const Map& map, const std::deque<SearchedPiece>& pieces, const PlaceAnswer& answer,
                         const EngineOptions& options) {
  const SearchedPiece& newest = pieces.back();
  Hypothesis hypothesis{whereabouts(map, answer), {}};
  for (auto piece = pieces.rbegin(); piece != pieces.rend(); ++piece) {
    if (piece->best_first.empty() || map.graph().island(piece->newest) != map.graph().island(newest.newest))
      continue;
    const Pose moved = map.relative_pose(newest.newest, piece->newest);
    const Whereabouts there{hypothesis.at.island, hypothesis.at.island_from_piece * moved};
    hypothesis.fits.push_back(fit_there(map, *piece, there, newest.at_m - piece->at_m, options));
  }
  return hypothesis;
}

// Log-odds that the pieces fit better there than elsewhere by being there. A piece that was not found there
// fits worse than what would have made it ambiguous.
double log_odds_against(const Hypothesis& other, const Hypothesis& hypothesis, const EngineOptions& options) {
  const double not_found = options.ambiguity.share;
  double better_by = 0;
  for (std::size_t i = 0; i < hypothesis.fits.size(); ++i)
    better_by += std::max(hypothesis.fits[i], not_found) - std::max(other.fits[i], not_found);
  return options.answers_along_way.log_odds_per_fit * better_by - options.answers_along_way.prior_log_odds;
}

// The same against ground that only looks alike: the robot came to where it is found at one of the pieces,
// whichever explains most, and they fit there since.
double log_odds_against_new_ground(const Hypothesis& hypothesis, const AnswersAlongWayOptions& options) {
  const double found = std::log(options.found_where_true / options.found_where_alike);
  const double missed = std::log((1 - options.found_where_true) / (1 - options.found_where_alike));
  double sum = 0;
  double most = 0;
  for (const double fit : hypothesis.fits) most = std::max(most, sum += fit > 0 ? found : missed);
  return most;
}

bool same_answer(const Hypothesis& a, const Hypothesis& b, const CommonOptions& options) {
  if (a.at.island != b.at.island) return false;
  const Pose off = ominus(a.at.island_from_piece, b.at.island_from_piece);
  return options.is_within(off, options.apart_m);
}

}  // namespace

void AnswersAlongWay::add(SearchedPiece piece, const AnswersAlongWayOptions& options) {
  if (piece.best_first.size() > options.max_answers)
    piece.best_first.erase(piece.best_first.begin() + static_cast<std::ptrdiff_t>(options.max_answers),
                           piece.best_first.end());
  const double from_m = piece.at_m - options.max_way_m;
  pieces_.push_back(std::move(piece));
  while (pieces_.front().at_m < from_m) pieces_.pop_front();
}

std::optional<PlaceAnswer> AnswersAlongWay::all_but_certain(const Map& map,
                                                            const EngineOptions& options) const {
  if (pieces_.empty()) return std::nullopt;
  const std::vector<PlaceAnswer>& answers = pieces_.back().best_first;
  std::vector<Hypothesis> hypotheses;
  for (const PlaceAnswer& answer : answers)
    hypotheses.push_back(hypothesis_of(map, pieces_, answer, options));
  for (std::size_t i = 0; i < answers.size(); ++i) {
    double by_rival = 0;
    for (const Hypothesis& other : hypotheses)
      if (!same_answer(other, hypotheses[i], options.common))
        by_rival = std::max(by_rival, std::exp(-log_odds_against(other, hypotheses[i], options)));
    const double by_new_ground =
        std::exp(-log_odds_against_new_ground(hypotheses[i], options.answers_along_way));
    const double against = by_rival + by_new_ground;
    if (1 / (1 + against) > options.answers_along_way.min_probability) return answers[i];
  }
  return std::nullopt;
}

void AnswersAlongWay::forget_robot(const Map& map, const std::string& robot) {
  const auto is_its = [&](PatchId patch) { return map.manifold().patch(patch).robot == robot; };
  std::erase_if(pieces_, [&](const SearchedPiece& piece) { return is_its(piece.newest); });
  for (SearchedPiece& piece : pieces_)
    std::erase_if(piece.best_first, [&](const PlaceAnswer& answer) { return is_its(answer.anchor); });
}

}  // namespace isthmus
