// How a FeatureMapper puts one map into another, and tells of all.

#include <algorithm>

#include "server/feature_maps/mapper/feature_mapper.hpp"

namespace isthmus {

void FeatureMapper::join_by_landmarks() {
  for (std::size_t a = 0; a < teams_.size(); ++a) {
    for (std::size_t b = a + 1; b < teams_.size(); ++b) {
      if (teams_[a].journeys.empty() || teams_[b].journeys.empty()) continue;
      teams_[a].filter.gather();
      teams_[b].filter.gather();
      const auto joined =
          joined_by_landmarks(teams_[a], teams_[b], options_.min_landmarks, options_.sighting_probability);
      if (joined) join(static_cast<int>(a), static_cast<int>(b), *joined);
    }
  }
}

void FeatureMapper::join(int one, int two, const JoinedTeams& joined) {
  Team& kept = teams_[static_cast<std::size_t>(one)];
  Team& gone = teams_[static_cast<std::size_t>(two)];
  const int ids = kept.filter.state().next_id;
  FeatureState state = joined.state;
  std::map<int, int> kept_as;  // features of the map that goes, by ids in the joint state
  for (const Fusion::Duplicate& duplicate : joined.duplicates) kept_as[duplicate.gone] = duplicate.kept;
  for (const auto& [barcode, id] : gone.landmarks) {
    if (kept.landmarks.try_emplace(barcode, id + ids).second) continue;
    if (const auto twin = index_of(state, id + ids)) {
      remove_feature(state, *twin);
      kept_as[id + ids] = kept.landmarks.at(barcode);
    }
  }
  for (const int number : gone.journeys) {
    Journey& moved = journeys_[static_cast<std::size_t>(number)];
    moved.team = one;
    moved.member = static_cast<int>(kept.journeys.size());
    for (JourneyRow& row : moved.rows) row.map_from_robot = joined.one_from_two * row.map_from_robot;
    for (Stop& stop : moved.stops) {
      stop.map_from_robot = joined.one_from_two * stop.map_from_robot;
      for (FeatureView& view : stop.views) {
        const auto twin = kept_as.find(view.id + ids);
        view.id = twin == kept_as.end() ? view.id + ids : twin->second;
      }
    }
    for (FreeView& view : moved.views) view.map_from_laser = joined.one_from_two * view.map_from_laser;
    for (Heard& heard : heard_) {  // with other maps
      if (heard.observer == number) heard.clue.observer = joined.one_from_two * heard.clue.observer;
      if (heard.target == number) heard.clue.target = joined.one_from_two * heard.clue.target;
    }
    kept.journeys.push_back(number);
  }
  kept.filter.replace(std::move(state));
  hand_over_meetings(one, two, ids);
  gone.journeys.clear();
  gone.landmarks.clear();
  ++counts_.fusions;
}

FeatureMaps FeatureMapper::maps() const {
  FeatureMaps maps{options_.kind, {}, journeys_, sightings_, {}, counts_};
  for (const auto& [id, fusion] : fusions_) maps.fusions.push_back(fusion);
  std::vector<int> order;
  for (std::size_t i = 0; i < teams_.size(); ++i)
    if (!teams_[i].journeys.empty()) order.push_back(static_cast<int>(i));
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return teams_[static_cast<std::size_t>(a)].filter.feature_count() >
           teams_[static_cast<std::size_t>(b)].filter.feature_count();
  });
  for (const int i : order) {
    for (const int number : teams_[static_cast<std::size_t>(i)].journeys)
      maps.journeys[static_cast<std::size_t>(number)].team = static_cast<int>(maps.teams.size());
    maps.teams.push_back(teams_[static_cast<std::size_t>(i)]);
    maps.teams.back().filter.gather();
  }
  return maps;
}

}  // namespace isthmus
