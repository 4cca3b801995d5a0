#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "server/engine/input/event.hpp"
#include "server/engine/robot/odometry_noise.hpp"
#include "server/engine/robot/odometry_track.hpp"
#include "server/feature_maps/merging/free_view.hpp"
#include "server/feature_maps/tracking/scan_tracker.hpp"
#include "server/feature_maps/ways/stop.hpp"
#include "server/features/state/state.hpp"

namespace isthmus {

/// Where a robot was at a stamp, in its map's frame: as the filter had it then, until it is smoothed.
struct JourneyRow {
  std::int64_t utime = 0;
  Pose map_from_robot;

  auto members() { return std::tie(utime, map_from_robot); }
};

/// One robot between two restarts: which map it is in, and its way there.
struct Journey {
  std::string robot;
  int team = -1;   ///< index of its map
  int member = 0;  ///< which of the map's robots it is
  std::vector<JourneyRow> rows;
  std::vector<Stop> stops;
  std::vector<FreeView> views;  ///< one a place: what it saw free, for maps that may be one

  auto members() { return std::tie(robot, team, member, rows, stops, views); }
};

/// Rows of those that are in a team's map become where the map as it is now has the robots. Of all journeys.
void smooth(std::span<Journey> journeys, int team, const FeatureState& map);

/// What is known of one robot beside the maps.
struct FeatureRobot {
  RobotEvent declared;
  OdometryTrack odometry;
  int journey = -1;                ///< the present one; -1 before the first
  ScanTracker tracker;             ///< its way from scan to scan
  OdometryPath since_tracked;      ///< what its filter was moved by odometry since the last scan used
  OdometryPath since_stop;         ///< what its filter was moved by since its last stop
  Pose odom_from_last;             ///< odometry where its filter stands
  Pose odom_from_robot;            ///< at the last input,
  std::int64_t last_utime = 0;     ///< and its stamp
  double way_m = 0, turn_rad = 0;  ///< since a scan was used
  bool matched = false;            ///< the last scan that was used, by a feature of the map at least
  std::deque<Event> waiting;       ///< scans and sightings that odometry has not reached

  auto members() {
    return std::tie(declared, odometry, journey, tracker, since_tracked, since_stop, odom_from_last,
                    odom_from_robot, last_utime, way_m, turn_rad, matched, waiting);
  }
};

}  // namespace isthmus
