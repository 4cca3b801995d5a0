#pragma once

#include <cstddef>
#include <cstdint>

#include "patches/option_unit.hpp"
#include "relations/chi_squared.hpp"
#include "server/engine/input/options/common_options.hpp"

namespace isthmus {

/// A change passed on through the map (Howard et al. 2006, IV-B, steps 2 to 5), see
/// propagation/propagation.hpp.
struct PropagationOptions {
  CommonOptions common;
  int max_visits = 4;
  double slack_m = 2;
  std::int64_t step_price_us = 5'000;
  double work_share = 0.5;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(max_visits, "max_visits", "count", "of one patch to the queue");
    option(slack_m, "slack_m", "m",
           "that a candidate may lie farther away than a local map reaches (surroundings.reach_m)");
    option(step_price_us, "step_price_us", "µs", "nominal, of one step, in a trial or of proximity matching");
    option(work_share, "work_share", share_unit,
           "of event time for trials, and as much for proximity matching");
  }
};

/// How much two maps share, laid over one another, see propagation/shared_part.hpp.
struct SharedPartOptions {
  double stride_m = 1;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(stride_m, "stride_m", "m", "of way that is a place of its own");
  }
};

/// The trial of a proposed closure, see propagation/trial.hpp.
struct TrialOptions {
  CommonOptions common;
  ChiSquaredTest max_jump{0.999985};
  double max_contradiction = 0.08;
  double even_sighting_cost = 0.75;
  double log_odds_per_sighting_cost = 3;
  double max_find_cost = 3;
  double max_relation_cost = 50;
  double min_matched_share = 0.4;
  int min_support_two_way = 4;
  int few_matched_scans = 4;
  double min_way_m = 15;
  double log_odds_per_way_m = 0.4;
  double log_odds_per_unmatched_m = 0.6;
  double repeats_probability = 0.01;
  double log_odds_per_width_m = 1;
  double log_odds_per_sighting = 1.5;
  double even_find_cost = 0.7;
  double log_odds_per_find_cost = 5;
  double log_odds_per_contradiction = 33;
  int even_layered_pairs = 10;
  double log_odds_per_layered_pair = 0.1;
  double max_layers_log_odds = 1;
  double agreed_log_odds = 3;
  double lone_log_odds = 2;
  double min_loop_log_odds = 7;
  double min_width_m = 2;
  double min_own_m = 5;
  double min_whole_log_odds = 25;
  std::size_t max_matched_scans = 150;
  std::size_t first_queue = 80;
  std::size_t growth = 3;
  int max_pairs = 300;
  int max_unmatched = 8;
  double contradiction_bound_m = 0.3;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(max_jump, "max_jump", "probability",
           "χ² of 3: how far a loop may move the map, in the map's own sigmas");
    option(max_contradiction, "max_contradiction", share_unit,
           "of hits that may lie deep in the other side's free space");
    option(even_sighting_cost, "even_sighting_cost", "χ² of 1",
           "mean over the sightings after the fit; true ones whose noise is as they say stay below 0.76");
    option(log_odds_per_sighting_cost, "log_odds_per_sighting_cost", "log-odds",
           "against a closure whose sightings cost one more: those of true ones whose clock or mounting is "
           "off come to 4, those of false ones nearly always to 25");
    option(max_find_cost, "max_find_cost", "χ² of 3",
           "median over the relations of a merge's finds after the fit");
    option(max_relation_cost, "max_relation_cost", "χ²",
           "of one relation that counts for the mean over sightings");
    visit_scan_options(option);
  }

  /// What scans are asked for.
  template <class Visitor>
  void visit_scan_options(Visitor&& option) {
    option(min_matched_share, "min_matched_share", share_unit,
           "of the patches that were compared that must match, but for a loop by scans");
    option(min_support_two_way, "min_support_two_way", "count",
           "of sightings of either direction, where scans cannot tell");
    option(few_matched_scans, "few_matched_scans", "count",
           "of patches that must match for a merge by scans alone");
    option(min_way_m, "min_way_m", "m", "of way that a merge must share");
    option(log_odds_per_way_m, "log_odds_per_way_m", "log-odds/m",
           "that a loop or merge is true, of way that matches: ground looks alike for a few metres,");
    option(
        log_odds_per_unmatched_m, "log_odds_per_unmatched_m", "log-odds/m",
        "of way that both sides know and on which nothing matches (on trial 0.2 m of 144 true loops in the "
        "mean, 2.2 m of 48 false ones): against a loop, and a merge where another is possible");
    option(
        repeats_probability, "repeats_probability", "probability",
        "and so seldom what matches repeats itself as far as it goes, along or across: the most that either "
        "says for a loop");
    option(log_odds_per_width_m, "log_odds_per_width_m", "log-odds/m",
           "the same of what matches across its length: corridors repeat themselves most");
    option(log_odds_per_sighting, "log_odds_per_sighting", "log-odds",
           "of each sighting beyond two that agrees: of false ones that agree by chance, or as one misread "
           "barcode leads to another, one more does so in one of five sets or fewer");
    option(even_find_cost, "even_find_cost", "χ² of 3",
           "that of finds that do not speak against a loop: the usual one of true ones");
    option(log_odds_per_find_cost, "log_odds_per_find_cost", "log-odds",
           "against a loop whose finds pull at one another by one more than that");
    option(log_odds_per_contradiction, "log_odds_per_contradiction", "log-odds",
           "against a loop that puts all hits deep in free space, beyond what either side does itself: true "
           "ones put three in a hundred there, or fewer");
    option(even_layered_pairs, "even_layered_pairs", "count",
           "of patches that contradict one another: so many fewer or more say nothing");
    option(log_odds_per_layered_pair, "log_odds_per_layered_pair", "log-odds",
           "for a loop, of each more that contradict one another without it and not with it, and against it "
           "the other way round");
    option(max_layers_log_odds, "max_layers_log_odds", "log-odds",
           "of that at most, and from how near to enough it is asked for: a false loop near the true one may "
           "end them as well");
    option(
        agreed_log_odds, "agreed_log_odds", "log-odds",
        "that what sightings say alike is true, before it is tried, and the most that several finds say: 95 "
        "in 100 (281 of 296 loops in simulated and recorded buildings)");
    option(lone_log_odds, "lone_log_odds", "log-odds",
           "the most that a find says by itself: buildings repeat themselves more often than it can know");
    option(min_loop_log_odds, "min_loop_log_odds", "log-odds",
           "of all these, and of where the map had its ends, for which a loop is accepted: one such in a "
           "thousand is false; below the same of the other sign it is refused");
    option(min_width_m, "min_width_m", "m",
           "of what is shared across its length: less is called one corridor");
    option(min_own_m, "min_own_m", "m", "of way of either map beyond what they share");
    option(min_whole_log_odds, "min_whole_log_odds", "log-odds",
           "of what matches, for which a merge needs no such way: rooms and wings look alike, hardly floors");
    option(max_matched_scans, "max_matched_scans", "count",
           "of patches: a few dozen that match tell as much as a thousand");
    option(first_queue, "first_queue", "count", "of patches around the closure that are tried first");
    option(growth, "growth", "factor", "in matched patches after which the island is fitted as a whole");
    option(max_pairs, "max_pairs", "count", "of patches that are looked at for walls in free space");
    option(max_unmatched, "max_unmatched", "count", "of unmatched patches that are looked at");
    option(contradiction_bound_m, "contradiction_bound_m", "m",
           "95 % bound: where nothing matched, only patches so well known relative to one another can "
           "contradict one another");
  }
};

}  // namespace isthmus
