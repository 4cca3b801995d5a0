#pragma once

#include <cstddef>
#include <cstdint>

#include "patches/option_unit.hpp"

namespace isthmus {

/// Searching for what robots saw last wherever it may have been before, see hypotheses/hypotheses.hpp.
struct HypothesisOptions {
  double query_every_m = 2;
  double max_piece_way_m = 8;
  double min_piece_way_m = 5;
  std::size_t max_queries = 8;
  double min_score = 0.5;
  double min_score_anywhere = 0.6;
  double work_share = 0.02;
  std::int64_t max_credit_us = 10'000;
  std::size_t max_finds = 64;
  std::size_t max_recorded_finds = 10'000;
  double min_find_probability = 0.12;
  std::size_t min_merge_finds = 3;
  double min_log_odds = 1;
  double min_merge_log_odds = 3;
  std::size_t agreement_patches = 200;
  double known_sigma_m = 4;
  double rival_m = 6;
  double hint_way_m = 40;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(query_every_m, "query_every_m", "m", "of a robot's way between two searches");
    option(max_piece_way_m, "max_piece_way_m", "m", "of its way that is searched for");
    option(min_piece_way_m, "min_piece_way_m", "m", "of its way before it is searched for");
    option(max_queries, "max_queries", "count", "that wait; the oldest goes");
    option(min_score, "min_score", share_unit, "of the search at a place that is an answer");
    option(min_score_anywhere, "min_score_anywhere", share_unit,
           "the same on islands where nothing says where to look");
    option(work_share, "work_share", share_unit, "of event time for the search");
    option(max_credit_us, "max_credit_us", "µs", "of it that can be saved up");
    option(max_finds, "max_finds", "count", "that wait for others that agree; the oldest goes");
    option(max_recorded_finds, "max_recorded_finds", "count", "that are told; the oldest goes");
    option(min_find_probability, "min_find_probability", "probability",
           "of a find that waits for others that agree");
    option(min_log_odds, "min_log_odds", "log-odds",
           "that finds come to that are proposed, those that agree together; of two islands");
    option(min_merge_finds, "min_merge_finds", "count", "it takes so many that agree");
    option(min_merge_log_odds, "min_merge_log_odds", "log-odds",
           "and come to so much, as they may well be two buildings that look alike");
    option(agreement_patches, "agreement_patches", "count",
           "of patches, nearest in the graph, to know how ends of finds lie to each other");
    option(known_sigma_m, "known_sigma_m", "m",
           "standard deviation: a map that knows less well than this where a find is asks for caution");
    option(rival_m, "rival_m", "m", "between finds of the same stretch of way that say otherwise");
    option(hint_way_m, "hint_way_m", "m", "of way over which a find that waits says where to look next");
  }
};

}  // namespace isthmus
