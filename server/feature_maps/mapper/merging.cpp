// How a FeatureMapper finds that two maps are one by their walls alone.

#include <algorithm>
#include <cmath>

#include "server/feature_maps/mapper/feature_mapper.hpp"
#include "server/feature_maps/merging/placing_judgement.hpp"

namespace isthmus {

std::size_t FeatureMapper::views_of(int team) const {
  std::size_t views = 0;
  for (const int number : teams_[static_cast<std::size_t>(team)].journeys)
    views += journeys_[static_cast<std::size_t>(number)].views.size();
  return views;
}

MapSketch FeatureMapper::sketch(const Team& team) const {
  std::set<int> robots;
  std::vector<const std::vector<FreeView>*> views;
  for (const int number : team.journeys) {
    robots.insert(journeys_[static_cast<std::size_t>(number)].member);
    views.push_back(&journeys_[static_cast<std::size_t>(number)].views);
  }
  return sketch_of(team.filter.state(), robots, views, options_.merging);
}

bool FeatureMapper::have_grown(std::size_t views_then, std::size_t views) const {
  const double share = options_.merging.grown_share * static_cast<double>(views_then);
  return views >= views_then + std::max(options_.merging.grown_views, static_cast<std::size_t>(share));
}

/// Whether two maps have grown so much since this was asked that it is worth while.
bool FeatureMapper::may_tell_more(int one, int two) {
  const std::size_t of_one = views_of(one), of_two = views_of(two), both = of_one + of_two;
  if (std::min(of_one, of_two) < options_.merging.min_views) return false;
  std::size_t& asked = asked_[std::minmax(one, two)];
  if (asked > 0 && !have_grown(asked, both)) return false;
  asked = both;
  return true;
}

/// A map that has grown is laid over the others.
void FeatureMapper::lay_over_others(int grown, const MapInput& input) {
  for (int other = 0; other < static_cast<int>(teams_.size()); ++other) {
    if (other == grown || teams_[static_cast<std::size_t>(other)].journeys.empty()) continue;
    const auto [one, two] = std::minmax(grown, other);
    if (may_tell_more(one, two) && merge_by_walls(one, two, input)) return;
  }
}

/// The first journey of a map that has views: its beginning is a place that both maps keep.
int FeatureMapper::first_with_views(const Team& team) const {
  return *std::find_if(team.journeys.begin(), team.journeys.end(), [&](int number) {
    return !journeys_[static_cast<std::size_t>(number)].views.empty();
  });
}

/// The record of a placing, which may have been proposed before; of a new one else.
FusionRecord& FeatureMapper::record_of_placing(int one, int two, const Pose& one_from_two,
                                               const Eigen::Vector2d& middle, const MapInput& input) {
  const Team &first = teams_[static_cast<std::size_t>(one)], &second = teams_[static_cast<std::size_t>(two)];
  const auto start = [&](int number) {
    return journeys_[static_cast<std::size_t>(number)].rows.front().map_from_robot;
  };
  const auto is_on = [&](int number, int team) {
    return journeys_[static_cast<std::size_t>(number)].team == team;
  };
  for (auto& [id, known] : fusions_) {
    if (!known.placing) continue;
    const auto& [journey_1, journey_2, start_1_from_start_2] = *known.placing;
    const Pose placed = start(journey_1) * start_1_from_start_2 * inverse(start(journey_2));
    const bool as_is = is_on(journey_1, one) && is_on(journey_2, two);
    const bool reversed = is_on(journey_1, two) && is_on(journey_2, one);
    if ((as_is || reversed) && is_same_placing(as_is ? placed : inverse(placed), one_from_two, middle,
                                               options_.merging, options_.merging.same_fusion))
      return known;
  }
  FusionRecord& record = fusions_[first_by_walls + input.number];
  record.id = first_by_walls + input.number;
  const int journey_1 = first_with_views(first), journey_2 = first_with_views(second);
  record.placing = {journey_1, journey_2, ominus(one_from_two * start(journey_2), start(journey_1))};
  return record;
}

void FeatureMapper::forget_waiting_by_walls(int one, int two, std::int32_t but) {
  std::erase_if(fusions_, [&](const auto& entry) {
    const auto& [id, fusion] = entry;
    if (id == but || !fusion.placing || fusion.state != FusionState::waiting) return false;
    const int of_1 = journeys_[static_cast<std::size_t>(fusion.placing->journey_1)].team;
    const int of_2 = journeys_[static_cast<std::size_t>(fusion.placing->journey_2)].team;
    return std::minmax(of_1, of_2) == std::minmax(one, two);
  });
}

/// What sightings that wait say of a placing: each encounter is what it says with a probability.
double FeatureMapper::clues_log_odds(std::span<const Heard> heard, const Pose& one_from_two,
                                     std::set<std::size_t>& agreeing) const {
  std::map<int, double> of_encounter;
  for (const Heard& one : heard) {
    Clue clue = one.clue;
    clue.target_covariance.diagonal().array() += std::pow(options_.merging.placing_sigma_m, 2);
    const double ratio = clue_log_ratio(clue, one_from_two, options_.placement);
    of_encounter[clue.encounter] += ratio;
    if (ratio > 0 && clue.kind != ClueKind::same_place) agreeing.insert(one.row);
  }
  double sum = 0;
  const double share = options_.placement.true_share;
  for (const auto& [encounter, ratio] : of_encounter)
    sum += std::log(share * std::exp(std::min(ratio, 500.0)) + 1 - share);
  return sum;
}

/// Makes one map of two where walls, and sightings that wait, are enough; else nothing changes.
bool FeatureMapper::merge_by_walls(int one, int two, const MapInput& input) {
  Team &first = teams_[static_cast<std::size_t>(one)], &second = teams_[static_cast<std::size_t>(two)];
  first.filter.gather();
  second.filter.gather();
  const MapSketch sketch_1 = sketch(first), sketch_2 = sketch(second);
  const std::optional<PlacingJudgement> judged = judge_placings(sketch_1, sketch_2, options_.merging);
  if (!judged || judged->log_odds <= 0) {
    forget_waiting_by_walls(one, two, -1);
    return false;
  }
  const Pose& placing = judged->best.one_from_two;
  FusionRecord& record = record_of_placing(one, two, placing, sketch_2.middle, input);
  forget_waiting_by_walls(one, two, record.id);
  std::vector<Heard> heard = tags_between(one, two);
  for (Heard& sighting : heard_between(one, two)) heard.push_back(std::move(sighting));
  std::set<std::size_t> agreeing;
  record.clues_log_odds = clues_log_odds(heard, placing, agreeing);
  record.clues = agreeing.size();
  record.twins_log_odds = judged->log_odds;
  record.duplicates = judged->best.explained;
  record.utime = input.utime;
  std::set<std::string> robots;
  for (const Team* team : {&first, &second})
    for (const int number : team->journeys) robots.insert(journeys_[static_cast<std::size_t>(number)].robot);
  record.robots.assign(robots.begin(), robots.end());
  record.state = forbidden_.contains(record.id) ? FusionState::withdrawn : FusionState::waiting;
  if (record.state == FusionState::withdrawn || record.log_odds() < options_.fusion_log_odds) return false;
  std::vector<TwinSeed> seeds;
  for (const WallTwin& twin : surest_twins(sketch_1, judged->best, options_.merging))
    seeds.push_back({sketch_1.walls[twin.one].feature, sketch_2.walls[twin.two].feature});
  const std::optional<JoinedTeams> joined = joined_by_twins(first, second, placing, seeds, options_.fusion);
  if (!joined) return false;
  accept(one, two, *joined, agreeing, record);
  return true;
}

}  // namespace isthmus
