#pragma once

#include <cstddef>
#include <cstdint>

#include "patches/option_unit.hpp"
#include "server/engine/input/options/common_options.hpp"

namespace isthmus {

/// Which places are searched for what a robot saw last, see places/place_candidates.hpp.
struct PlaceCandidateOptions {
  CommonOptions common;
  double spacing_m = 4;
  double window_margin_m = 1;
  double reach_m = 5;
  double min_way_m = 10;
  double drift_per_way = 0.3;
  double min_drift_m = 1;
  double drift_rad_per_m = 0.006;
  double systematic_share = 0.012;
  double systematic_m = 0.2;
  double systematic_rad_per_m = 0.0004;
  double slip_probability = 0.05;
  std::size_t max_places = 40;
  std::size_t min_island = 6;
  std::int64_t us_per_patch = 3'000;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(spacing_m, "spacing_m", "m", "between anchors of places, and half the window about each");
    option(window_margin_m, "window_margin_m", "m", "beyond that window, on the robot's own island");
    option(reach_m, "reach_m", "m", "so near, two views overlap");
    option(min_way_m, "min_way_m", "m", "over the map: nearer, it is the same stretch of way");
    option(drift_per_way, "drift_per_way", share_unit,
           "of the way: more than any map errs before loops close, whatever it believes of itself");
    option(min_drift_m, "min_drift_m", "m", "of that, however short the way");
    option(drift_rad_per_m, "drift_rad_per_m", "rad/m", "the same of the yaw");
    option(systematic_share, "systematic_share", share_unit,
           "of the way that maps err by beyond their covariance: no sensor errs at random only (standard "
           "deviation)");
    option(systematic_m, "systematic_m", "m", "and however short the way");
    option(systematic_rad_per_m, "systematic_rad_per_m", "rad/m", "the same of the yaw");
    option(slip_probability, "slip_probability", "probability",
           "of a way that wheels slipped on it and the map may be off by anything");
    option(max_places, "max_places", "count", "of one island that are searched");
    option(min_island, "min_island", "count", "of patches: less is no place");
    option(us_per_patch, "us_per_patch", "µs",
           "of event time after which what was looked up is applied, per patch of the map: hardly ever late");
  }
};

/// The search for a piece of a robot's way at a place, see places/place_search.hpp.
struct PlaceSearchOptions {
  CommonOptions common;
  double place_radius_m = 8;
  std::size_t max_place_patches = 30;
  double thin_m = 0.15;
  double coarse = 2;
  long coarse_evaluations = 60'000;
  double fine_second_share = 0.95;
  double max_weak_sigma_m = 0.25;
  std::size_t max_carriers = 4;
  std::int64_t step_price_us = 1'000;
  double evaluation_price_us = 0.1;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(place_radius_m, "place_radius_m", "m", "around its anchor");
    option(max_place_patches, "max_place_patches", "count", "of a place");
    option(thin_m, "thin_m", "m", "side of the cells that keep one point each");
    option(coarse, "coarse", "factor",
           "on the cells, the blur and the steps of yaw of the first search, in the whole window");
    option(coarse_evaluations, "coarse_evaluations", "count", "correlative.max_evaluations of that");
    option(fine_second_share, "fine_second_share", share_unit, "correlative.second_share of that");
    option(max_weak_sigma_m, "max_weak_sigma_m", "m",
           "standard deviation of that scan along the direction that its beams determine least");
    option(max_carriers, "max_carriers", "count",
           "of newest patches, the best of which carries the relations");
    option(step_price_us, "step_price_us", "µs", "nominal, of one step at least");
    option(evaluation_price_us, "evaluation_price_us", "µs",
           "nominal, of an evaluation of the search: measured, 0.08 to 0.12");
  }
};

/// How sure it is that a piece of way that fits one place only was there, see places/place_search.hpp. By
/// logistic regression over 1,202 such answers of the simulated unseen buildings 3001 to 3060, a campus and
/// the real logs, 777 of them true; what else was looked at (score of the match of the whole piece, length of
/// the way) adds nothing to these.
struct FindEvidenceOptions {
  double against_no_score = 12.3;
  double per_search_score = 7.6;
  double per_carrier_score = 7.3;
  double per_seen_again = 4.6;
  double against_anywhere = 1.3;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(against_no_score, "against_no_score", "log-odds", "that it was there, where scores are zero");
    option(per_search_score, "per_search_score", "log-odds", "for it, of each unit of the search's score");
    option(per_carrier_score, "per_carrier_score", "log-odds",
           "and of the score of the scan that carries the relations");
    option(per_seen_again, "per_seen_again", "log-odds",
           "and of the shares of what each had in view of the other that it saw");
    option(against_anywhere, "against_anywhere", "log-odds", "on islands where nothing says where to look");
  }
};

/// Which of several places that look alike a robot's way leads over, see places/answers_along_way.hpp.
/// log_odds_per_fit and prior_log_odds are what 815 answers to ambiguous searches of the simulated unseen
/// buildings 1 to 31 come to, counted by how much better they fit along the way; found_where_true and
/// found_where_alike are shares of the same.
struct AnswersAlongWayOptions {
  double max_way_m = 60;
  std::size_t max_answers = 16;
  double log_odds_per_fit = 7;
  double prior_log_odds = 2.5;
  double found_where_true = 0.9;
  double found_where_alike = 0.5;
  double min_probability = 0.9;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(max_way_m, "max_way_m", "m", "of a robot's way that is looked back on");
    option(max_answers, "max_answers", "count", "of a piece of way that are kept");
    option(log_odds_per_fit, "log_odds_per_fit", "log-odds",
           "for a place by whose side the pieces fit better: of their fits as shares of the best, summed");
    option(prior_log_odds, "prior_log_odds", "log-odds", "against any one place, before");
    option(found_where_true, "found_where_true", "probability",
           "that a piece is found where the robot is, on ground that the map has");
    option(found_where_alike, "found_where_alike", "probability",
           "that a piece is found where a building only repeats itself");
    option(min_probability, "min_probability", "probability", "of an answer that is taken");
  }
};

/// Whether two finds agree around the loop that they form, see places/consistency.hpp.
struct ConsistencyOptions {
  CommonOptions common;
  double find_sigma_m = 0.12;
  int max_steps = 20'000;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(find_sigma_m, "find_sigma_m", "m", "standard deviation of a find's position");
    option(max_steps, "max_steps", "count", "of the search for the largest consistent set");
  }
};

}  // namespace isthmus
