#pragma once

#include <cstdint>

namespace isthmus {

/// How far odometry is trusted, see robot/odometry_noise.hpp. Variances are those at scale 1: they grow with
/// the way, as those of a random walk do, from a floor of what encoders resolve.
struct OdometryNoiseOptions {
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
  double well_known = 0.8;
  double rest_m = 0.01;
  double rest_rad = 0.005;
  double outlier_sigmas = 4;
  double path_forgetting = 0.05;
  double plausible_path = 7.8;
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
    option(forgetting, "forgetting", "share", "of the learned variance that one step replaces");
    option(min_scale, "min_scale", "factor", "that is learned at least");
    option(max_scale, "max_scale", "factor", "that is learned at most");
    option(well_known, "well_known", "share",
           "trust in the direction of the way above which translation is learned from a match");
    option(rest_m, "rest_m", "m", "a shorter way tells only how matching trembles");
    option(rest_rad, "rest_rad", "rad", "and a smaller rotation");
    option(outlier_sigmas, "outlier_sigmas", "sigmas", "larger disagreements count as this");
    option(path_forgetting, "path_forgetting", "share", "of the path's scale that one path replaces");
    option(plausible_path, "plausible_path", "χ² of 3",
           "that a path may be off by, 95 % of them; where it is off by more, its covariance is widened");
    option(min_path_scale, "min_path_scale", "factor", "on variances of a path that is learned at least");
  }
};

/// What is kept of where a robot was, see robot/pose_history.hpp.
struct PoseHistoryOptions {
  std::int64_t near_us = 500'000;
  double near_m = 0.05;
  double near_rad = 0.05;
  std::int64_t spacing_us = 400'000;
  std::int64_t newest_us = 60'000'000;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(near_us, "near_us", "µs", "a place within this time of the one before it,");
    option(near_m, "near_m", "m", "this way");
    option(near_rad, "near_rad", "rad", "and this rotation tells nothing new");
    option(spacing_us, "spacing_us", "µs", "of places that are kept where there are too many");
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

}  // namespace isthmus
