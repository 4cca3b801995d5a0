#pragma once

#include <cstddef>
#include <cstdint>

#include "patches/option_unit.hpp"
#include "relations/chi_squared.hpp"
#include "server/engine/input/options/common_options.hpp"

namespace isthmus {

/// Where a robot is at a scan (Howard et al. 2006, IV-A, steps 1 to 4), see localise/localise.hpp.
struct LocaliseOptions {
  CommonOptions common;
  double min_score = 0.25;
  double match_trust = 5;
  double max_speed_m_per_s = 5;
  double max_turn_rad_per_s = 3.5;
  double max_acceleration_m_per_s2 = 2;
  double min_period_s = 0.1;
  double slack_m = 0.3;
  double slack_rad = 0.5;
  double restart_jump_m = 0.5;
  double origin_m = 0.05;
  double origin_rad = 0.05;
  double implausible_variance_m2 = 0.25;
  double implausible_variance_rad2 = 0.1;
  double freeze_probability = 0.25;
  double match_variance_m2 = 4e-4;
  double match_variance_rad2 = 1e-4;
  ChiSquaredTest weighed_surprise{0.5};
  double slip_log_odds = 10;
  double thing_gap_m = 0.1;
  double flattest_rad = 0.17;
  double moving_thing_m = 1.2;
  double moves_along_log_odds = 4;
  double changed_log_odds = 8;
  double loose_share = 0.04;
  double loose_gain = 0.02;
  double other_start_gain = 0.05;
  double min_window_m = 0.4;
  double max_window_m = 1.5;
  double min_window_rad = 0.3;
  double max_window_rad = 1.2;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(min_score, "min_score", share_unit, "score below which a match is not believed");
    option(match_trust, "match_trust", "factor",
           "on a match's information against odometry's, from scan to scan: a match with many patches errs "
           "less than the nominal noise of its beams, odometry more than its steps say");
    option(max_speed_m_per_s, "max_speed_m_per_s", "m/s", "of a robot; faster odometry is implausible");
    option(max_turn_rad_per_s, "max_turn_rad_per_s", "rad/s", "of a robot; faster odometry is implausible");
    option(max_acceleration_m_per_s2, "max_acceleration_m_per_s2", "m/s²",
           "of a robot that may have set off while its odometry stood still");
    option(min_period_s, "min_period_s", "s", "between scans, for this test: stamps are often coarse");
    option(slack_m, "slack_m", "m", "that odometry may move beyond that speed");
    option(slack_rad, "slack_rad", "rad", "that odometry may turn beyond that speed");
    option(restart_jump_m, "restart_jump_m", "m",
           "a longer step that ends at odometry's origin is a robot that was switched off and on");
    option(origin_m, "origin_m", "m", "so near to it, odometry is at its origin,");
    option(origin_rad, "origin_rad", "rad", "turned by no more than this");
    option(implausible_variance_m2, "implausible_variance_m2", "m²",
           "of each axis after implausible odometry, when only matching can tell where the robot is");
    option(implausible_variance_rad2, "implausible_variance_rad2", "rad²", "the same of the yaw");
    option(freeze_probability, "freeze_probability", share_unit,
           "that a robot goes on as it did where its odometry stands still from one scan to the next");
    visit_surprise_options(option);
  }

  /// What is done with a match that ends far from the prediction.
  template <class Visitor>
  void visit_surprise_options(Visitor&& option) {
    option(match_variance_m2, "match_variance_m2", "m²",
           "what matching itself errs by, for the surprise at a match that ends away from the prediction");
    option(match_variance_rad2, "match_variance_rad2", "rad²", "the same of the yaw");
    option(weighed_surprise, "weighed_surprise", "probability",
           "χ² of 3 beyond which a match is weighed against odometry's account of the step");
    option(slip_log_odds, "slip_log_odds", "log-odds",
           "that wheels do not slip between two scans: so much worse must a scan fit where odometry puts the "
           "robot that a match far from there is believed, however far");
    option(flattest_rad, "flattest_rad", "rad",
           "of a surface to the beams: neighbouring points that only a flatter one joins are on different "
           "things");
    option(thing_gap_m, "thing_gap_m", "m", "and that noise may add to the gap between two points of one");
    option(moving_thing_m, "moving_thing_m", "m",
           "wider than this, a thing does not move along with the robot as people and robots do");
    option(moves_along_log_odds, "moves_along_log_odds", "log-odds",
           "that a smaller one does not either: two may, and then so much only is said by each of them");
    option(changed_log_odds, "changed_log_odds", "log-odds",
           "that what stands, in pieces of that width, is as it was when the map was made: so much only is "
           "said by each against where odometry puts the robot");
    option(loose_share, "loose_share", "factor", "on the information of the prediction from there");
    option(
        loose_gain, "loose_gain", share_unit,
        "that the score must be better by from the same beginning, held loosely, and may be worse by where "
        "implausible odometry says that the robot is: what stood still and then jumps may well be right");
    option(other_start_gain, "other_start_gain", share_unit, "the same from another beginning");
    option(min_window_m, "min_window_m", "m", "half width of the window that is searched at last: at least");
    option(max_window_m, "max_window_m", "m", "and at most");
    option(min_window_rad, "min_window_rad", "rad", "the same in yaw: at least");
    option(max_window_rad, "max_window_rad", "rad", "and at most");
  }
};

/// Following a robot over the manifold (eq. 14), and when it is lost, see localise/follow.hpp and mapper.hpp.
struct FollowOptions {
  double clearly_nearer_m = 0.2;
  double unmatched_points = 2;
  double spacing_share = 0.4;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(clearly_nearer_m, "clearly_nearer_m", "m",
           "by which another patch must be nearer for the robot to change to it");
    option(unmatched_points, "unmatched_points", "factor", "on match.min_pairs: points that it must have");
    option(spacing_share, "spacing_share", "factor",
           "on the spacing of patches: way or rotation after which the local map is chosen anew, and a scan "
           "that is not matched may become a patch");
  }
};

/// Which scans become patches (eq. 15), see localise/extend.hpp.
struct ExtendOptions {
  double thin_score = 0.5;
  double turned_score = 0.85;
  double turned_uncovered_share = 0.05;
  double here_share = 0.3;
  double near_reaches = 2;
  int same_place_hops = 2;
  std::size_t sampled_beams = 36;
  double max_sample_m = 8;
  int samples_of_beam = 3;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(thin_score, "thin_score", share_unit, "a match below this is on new ground: worth a patch");
    option(turned_score, "turned_score", share_unit,
           "a match below this, turned away from its neighbours, is worth a patch");
    option(turned_uncovered_share, "turned_uncovered_share", share_unit,
           "of the free area that none of them covers, above which one turned away is worth a patch");
    option(here_share, "here_share", "factor",
           "on the spacing of patches: nearer to one than this, a match on new ground adds none");
    option(near_reaches, "near_reaches", "factor",
           "on surroundings.reach_m: patches farther away cover nothing here");
    option(same_place_hops, "same_place_hops", "count",
           "of relations: so near in the graph, what lies together in the map does so in truth");
    option(sampled_beams, "sampled_beams", "count", "of the free space, for the share that is covered");
    option(max_sample_m, "max_sample_m", "m", "free space farther away is not looked at");
    option(samples_of_beam, "samples_of_beam", "count", "each for as much of the area that it sweeps");
  }
};

/// Robots without a laser, see localise/footprints.hpp.
struct FootprintOptions {
  std::int64_t period_us = 100'000;
  double way_step_m = 0.15;
  double min_radius_m = 0.1;
  int corners = 12;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(period_us, "period_us", "µs", "at least, between two poses that are published");
    option(way_step_m, "way_step_m", "m", "between the points of the swept way");
    option(min_radius_m, "min_radius_m", "m", "of the disc that sweeps, whatever the robot declares");
    option(corners, "corners", "count", "of that disc");
  }
};

}  // namespace isthmus
