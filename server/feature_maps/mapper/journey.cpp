#include "server/feature_maps/mapper/journey.hpp"

#include <algorithm>

#include "server/feature_maps/ways/smoothed_ways.hpp"

namespace isthmus {

namespace {

void smooth(Journey& journey, const std::vector<Pose>& poses) {
  const std::vector<Stop>& stops = journey.stops;
  if (stops.empty()) return;
  for (JourneyRow& row : journey.rows) {
    const auto after = std::ranges::upper_bound(stops, row.utime, {}, &Stop::utime);
    const auto last = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, after - stops.begin() - 1));
    row.map_from_robot = poses[last] * ominus(row.map_from_robot, stops[last].map_from_robot);
    if (row.utime < stops[last].utime || after == stops.end()) continue;
    // What the way to the next stop errs by comes little by little.
    const auto next = static_cast<std::size_t>(after - stops.begin());
    const Pose gap = ominus(poses[next], poses[last] * stops[next].from_last.start_from_end);
    const double share = static_cast<double>(row.utime - stops[last].utime) /
                         static_cast<double>(stops[next].utime - stops[last].utime);
    row.map_from_robot = row.map_from_robot * to_pose(share * to_vector(gap));
  }
}

}  // namespace

void smooth(std::span<Journey> journeys, int team, const FeatureState& map) {
  std::vector<std::span<const Stop>> ways;
  for (const Journey& journey : journeys)
    ways.push_back(journey.team == team ? std::span<const Stop>(journey.stops) : std::span<const Stop>());
  const std::vector<std::vector<Pose>> poses = smoothed_stops(ways, map);
  for (std::size_t i = 0; i < journeys.size(); ++i)
    if (journeys[i].team == team) smooth(journeys[i], poses[i]);
}

}  // namespace isthmus
