#pragma once

#include <cstdint>

#include "patches/option_unit.hpp"
#include "server/engine/input/options/common_options.hpp"

namespace isthmus {

/// How far odometry is trusted, see robot/odometry_noise.hpp. Variances are those at scale 1: they grow with
/// the way, as those of a random walk do, from a floor of what encoders resolve.
struct OdometryNoiseOptions {
  CommonOptions common;
  double translation_per_m = 3.2e-4;
  double translation_per_rad = 1e-4;
  double translation_floor_m2 = 4e-6;
  double rotation_per_m = 8e-5;
  double rotation_per_rad = 5e-4;
  double rotation_floor_rad2 = 4e-6;
  double first_scale = 1.5;
  double first_path_scale = 4;
  double forgetting = 0.005;
  double min_scale = 0.3;
  double max_scale = 20;
  double outlier_sigmas = 4;
  double path_forgetting = 0.05;
  double min_path_scale = 0.25;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(translation_per_m, "translation_per_m", "m", "variance of each axis per metre of way");
    option(translation_per_rad, "translation_per_rad", "m²/rad", "and per radian of rotation");
    option(translation_floor_m2, "translation_floor_m2", "m²", "and of any step");
    option(rotation_per_m, "rotation_per_m", "rad²/m", "variance of the yaw per metre of way");
    option(rotation_per_rad, "rotation_per_rad", "rad", "and per radian of rotation");
    option(rotation_floor_rad2, "rotation_floor_rad2", "rad²", "and of any step");
    option(first_scale, "first_scale", "factor", "on standard deviations, before anything is learned");
    option(
        first_path_scale, "first_path_scale", "factor",
        "on variances of a path of many steps, before anything is learned: errors of successive steps have "
        "a common part");
    option(forgetting, "forgetting", share_unit, "of the learned variance that one step replaces");
    option(min_scale, "min_scale", "factor", "that is learned at least");
    option(max_scale, "max_scale", "factor", "that is learned at most");
    option(outlier_sigmas, "outlier_sigmas", "sigmas", "larger disagreements count as this");
    option(path_forgetting, "path_forgetting", share_unit, "of the path's scale that one path replaces");
    option(min_path_scale, "min_path_scale", "factor", "on variances of a path that is learned at least");
  }
};

/// What a matched step must be for something to be learned of odometry from it, its noise or its bias.
struct OdometryLearningOptions {
  double well_known = 0.8;
  double rest_m = 0.01;
  double rest_rad = 0.005;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(well_known, "well_known", share_unit,
           "trust in a direction above which translation along it is learned from a match");
    option(rest_m, "rest_m", "m", "a shorter way tells only how matching trembles");
    option(rest_rad, "rest_rad", "rad", "and a smaller rotation");
  }
};

/// How well scans must fit where odometry does not tell that the robot is there, see robot/usual_misfit.hpp.
struct UsualMisfitOptions {
  double memory_scans = 500;
  double rare_share = 0.05;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(memory_scans, "memory_scans", "count", "that a robot's usual misfit is the mean of, about");
    option(rare_share, "rare_share", share_unit,
           "of scans that fit so badly where they belong: one that fits worse is not believed");
  }
};

/// What odometry errs by always, see robot/odometry_bias.hpp. Standard deviations are those of robots at
/// large.
struct OdometryBiasOptions {
  double turn_per_m_sigma = 0.03;
  double share_sigma = 0.04;
  double memory_m = 100;
  double memory_rad = 100;
  double match_sigma_m = 0.01;
  double match_sigma_rad = 0.004;
  double outlier_sigmas = 2;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(turn_per_m_sigma, "turn_per_m_sigma", "rad/m", "that a robot turns by as it drives, unnoticed");
    option(
        share_sigma, "share_sigma", share_unit,
        "of turns and of ways that are not counted, of ways that it drives aside, and of the radius 1 m that "
        "it moves aside by as it turns");
    option(memory_m, "memory_m", "m",
           "of way after which a step counts for a third: floors and loads change");
    option(memory_rad, "memory_rad", "rad", "of turns likewise");
    option(match_sigma_m, "match_sigma_m", "m", "standard deviation of a matched step");
    option(match_sigma_rad, "match_sigma_rad", "rad", "and of its yaw");
    option(outlier_sigmas, "outlier_sigmas", "sigmas", "a disagreement beyond this counts less (Huber)");
  }
};

/// How late a robot's scans are stamped, see robot/scan_delay.hpp.
struct ScanDelayOptions {
  double sigma_s = 0.3;
  double max_s = 1;
  double step_s = 0.025;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(sigma_s, "sigma_s", "s", "standard deviation of the delay, of robots at large");
    option(max_s, "max_s", "s", "of a delay that is looked for, either way");
    option(step_s, "step_s", "s", "between the delays that are compared");
  }
};

/// What is kept of where a robot was, see robot/pose_history.hpp.
struct PoseHistoryOptions {
  CommonOptions common;
  std::int64_t near_us = 500'000;
  double near_m = 0.05;
  std::int64_t newest_us = 60'000'000;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(
        near_us, "near_us", "µs",
        "a place within this time of the one before it, this way and a rotation as small tells nothing new; "
        "so far apart are those that are kept where there are too many");
    option(near_m, "near_m", "m", "the way, see near_us");
    option(newest_us, "newest_us", "µs", "that are left as they are: most sightings are of them");
  }
};

/// Where other robots' bodies hide walls, see robot/teammates.hpp.
struct TeammateOptions {
  double margin_m = 0.15;
  double speed_m_per_s = 0.7;
  double max_slack_m = 0.5;
  double slack_sigmas = 2;
  std::int64_t seen_us = 1'500'000;
  std::int64_t placed_us = 30'000'000;
  double max_age_s = 0.5;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(margin_m, "margin_m", "m", "around a declared footprint in which beams are left out");
    option(speed_m_per_s, "speed_m_per_s", "m/s", "at which a robot may leave where it was seen");
    option(max_slack_m, "max_slack_m", "m", "for that and for errors: a wider circle would take walls away");
    option(slack_sigmas, "slack_sigmas", "sigmas", "of where it was seen or placed");
    option(seen_us, "seen_us", "µs", "after which a sighting says nothing of who stands there now");
    option(placed_us, "placed_us", "µs", "of event time: a robot unheard of for longer may be gone");
    option(max_age_s, "max_age_s", "s", "of a placed robot that counts for how far it may have moved");
  }
};

/// What tells of a robot's sensors, see robot/robot_health.hpp. It decides nothing about the map.
struct HealthOptions {
  CommonOptions common;
  double closing_way_m = 0.3;
  double closing_turn_rad = 0.1;
  double max_turn_in_way_rad = 0.5;
  int max_scans = 20;
  double min_way_m = 0.05;
  double min_offset_turn_rad = 10;
  std::int64_t reference_age_us = 500'000;
  double still_m = 1e-3;
  double changed_m = 0.06;
  double changed_range_share = 0.02;
  double changed_share = 0.4;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(closing_way_m, "closing_way_m", "m", "of way that is summed up before it is compared");
    option(closing_turn_rad, "closing_turn_rad", "rad", "of rotation that is summed up before");
    option(max_turn_in_way_rad, "max_turn_in_way_rad", "rad", "of a way that is summed up");
    option(max_scans, "max_scans", "count", "that are summed up");
    option(min_way_m, "min_way_m", "m", "of such a way: less is the trembling of a robot at rest");
    option(min_offset_turn_rad, "min_offset_turn_rad", "rad",
           "of rotation to tell odometry's offset in time by");
    option(reference_age_us, "reference_age_us", "µs", "of the scan that one is compared with beam by beam");
    option(still_m, "still_m", "m", "of way by which odometry says that nothing moved");
    option(changed_m, "changed_m", "m", "of a beam's range that has changed,");
    option(changed_range_share, "changed_range_share", share_unit, "and of the range");
    option(changed_share, "changed_share", share_unit,
           "of the beams: a scan shows other surroundings; more than people who walk by hide");
  }
};

/// What is warned of, see robot/health_warnings.hpp.
struct HealthWarningOptions {
  CommonOptions common;
  std::int64_t min_messages = 20;
  std::int64_t min_beams = 12;
  double other_clock_s = 30;
  double min_way_m = 1;
  double min_turn_rad = 2;
  double never_moved_m = 0.01;
  std::int64_t min_changes = 10;
  double freezing_share = 0.1;
  double other_unit = 2.5;
  double still_share = 0.02;
  double still_units = 10;
  double other_scale = 1.3;
  double other_direction_rad = 0.4363323129985824;
  double backwards_rad = 2.356194490192345;
  double steady = 0.6;
  int late_scans = 2;
  double mostly = 0.5;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(min_messages, "min_messages", "count", "of a kind before anything is said of it");
    option(min_beams, "min_beams", "count", "of a scan: fewer cannot be matched");
    option(other_clock_s, "other_clock_s", "s", "by which a clock is another: more than messages take");
    option(min_way_m, "min_way_m", "m", "by the larger account, before ways are compared");
    option(min_turn_rad, "min_turn_rad", "rad", "the same of rotations");
    option(never_moved_m, "never_moved_m", "m", "of odometry that never moved");
    option(min_changes, "min_changes", "count", "of scans that show other surroundings");
    option(freezing_share, "freezing_share", share_unit, "of these while odometry stood still");
    option(other_unit, "other_unit", "factor", "too much or too little: no wheel wears off so far");
    option(still_share, "still_share", share_unit, "of odometry's way that the laser saw: it stood still");
    option(still_units, "still_units", "factor", "on other_unit, for the same");
    option(other_scale, "other_scale", "factor",
           "too much or too little of one unit; within it a ratio is that of a known unit");
    option(other_direction_rad, "other_direction_rad", "rad", "between odometry's way and the laser's: 25°");
    option(backwards_rad, "backwards_rad", "rad", "the same of a laser mounted backwards: 135°");
    option(steady, "steady", share_unit, "of a direction that is always the same; 0.96 in recorded logs");
    option(late_scans, "late_scans", "count", "of scans that odometry is late");
    option(mostly, "mostly", share_unit,
           "of the scans; of the motion that the laser saw, which odometry explains (of recorded logs 0.87 "
           "of ways, 0.74 of turns); "
           "of what is off without a shift, that a shift leaves; and by which turns go against one another "
           "(negative correlation)");
  }
};

}  // namespace isthmus
