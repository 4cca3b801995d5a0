#pragma once

#include <cstdint>

#include "patches/option_unit.hpp"

namespace isthmus {

/// Where two robots should meet to settle a hypothesis, see rendezvous/meeting_plan.hpp.
struct MeetingOptions {
  double search_m = 5;
  double distance_m = 1.75;
  double distance_step_m = 0.25;
  int bearings = 24;
  double wall_margin_m = 0.15;
  double sight_margin_m = 0.1;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(search_m, "search_m", "m", "around the hypothesis' patches in which places are looked for");
    option(distance_m, "distance_m", "m", "between the two robots");
    option(distance_step_m, "distance_step_m", "m", "that they may as well be nearer or farther");
    option(bearings, "bearings", "count",
           "of one from the other that are looked at, and of the points of an outline that must be free");
    option(wall_margin_m, "wall_margin_m", "m", "beyond a robot's footprint, to the nearest wall");
    option(sight_margin_m, "sight_margin_m", "m",
           "between the points of the line of sight, and by which they must lie in front of what was seen");
  }
};

/// Choosing a meeting and watching it, see rendezvous/rendezvous.hpp.
struct RendezvousOptions {
  std::int64_t choice_interval_us = 1'000'000;
  std::int64_t retry_interval_us = 10'000'000;
  int max_plans = 3;
  double worth_turning_for = 2;
  double in_place_m = 1;
  double facing_rad = 0.3490658503988659;
  std::int64_t watch_us = 5'000'000;
  std::int64_t max_gap_us = 1'000'000;
  double min_distance_m = 0.3;
  double seen_share = 0.5;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(choice_interval_us, "choice_interval_us", "µs", "between choices of a meeting");
    option(retry_interval_us, "retry_interval_us", "µs",
           "where no meeting can be had for the most valuable few: the maps must grow first");
    option(max_plans, "max_plans", "count", "that are tried at once");
    option(worth_turning_for, "worth_turning_for", "factor",
           "on the value of a meeting under way, that another must have to replace it");
    option(in_place_m, "in_place_m", "m", "of a robot from its place of the meeting");
    option(facing_rad, "facing_rad", "rad", "by which it may look past the other: 20°");
    option(watch_us, "watch_us", "µs", "that both must have stood face to face and seen nobody");
    option(max_gap_us, "max_gap_us", "µs", "between scans: after a longer one a watch begins anew");
    option(min_distance_m, "min_distance_m", "m", "nearer than that the two would touch");
    option(seen_share, "seen_share", share_unit,
           "of the other's radius that the beams must meet, and go beyond its middle");
  }
};

}  // namespace isthmus
