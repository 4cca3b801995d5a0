#pragma once

#include <string>
#include <tuple>

#include "patches/ids.hpp"
#include "patches/pose.hpp"

namespace isthmus {

/// A place where scans found a piece of a robot's way, once and only once or as the whole way tells, with
/// what speaks for it (see FindEvidenceOptions).
struct FindRecord {
  std::string robot;
  PatchId query;   ///< the robot's patch
  PatchId anchor;  ///< of the place
  Pose anchor_from_query;
  double way_m = 0;  ///< between the two over the map, then; 0: they were on two islands
  double search_score = 0;
  double carrier_score = 0;  ///< of the match of the query's scan
  double seen_again = 0;     ///< of what each had in view of the other, the shares that it saw
  int look_alikes = 1;       ///< places that look alike, of which this is one
  double log_odds = 0;       ///< that the robot was there
  bool waits = false;        ///< for others that agree, to be proposed with them; else it is too unsure

  auto members() {
    return std::tie(robot, query, anchor, anchor_from_query, way_m, search_score, carrier_score, seen_again,
                    look_alikes, log_odds, waits);
  }
};

}  // namespace isthmus
