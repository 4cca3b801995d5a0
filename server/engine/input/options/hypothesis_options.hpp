#pragma once

#include <cstddef>

#include "patches/option_unit.hpp"

namespace isthmus {

/// Searching for what robots saw last wherever it may have been before, see hypotheses/hypotheses.hpp.
struct HypothesisOptions {
  double query_every_m = 2;
  double max_piece_way_m = 8;
  double min_piece_way_m = 5;
  std::size_t max_queries = 8;
  double min_score = 0.3;
  double work_share = 0.02;
  std::size_t max_recorded_finds = 10'000;
  double min_find_probability = 0.12;
  double min_merge_log_odds = 3;
  double hint_way_m = 40;

  template <class Visitor>
  void visit_options(Visitor&& option) {
    option(query_every_m, "query_every_m", "m", "of a robot's way between two searches");
    option(max_piece_way_m, "max_piece_way_m", "m", "of its way that is searched for");
    option(min_piece_way_m, "min_piece_way_m", "m", "of its way before it is searched for");
    option(max_queries, "max_queries", "count", "that wait at a time; the oldest is put off until none does");
    option(min_score, "min_score", share_unit, "of the search at a place that is an answer");
    option(work_share, "work_share", share_unit, "of event time for the search");
    option(max_recorded_finds, "max_recorded_finds", "count", "that are told; the oldest goes");
    option(min_find_probability, "min_find_probability", "probability",
           "of a find that waits for others that agree");
    option(min_merge_log_odds, "min_merge_log_odds", "log-odds",
           "that finds of two islands come to that are proposed, those that agree together");
    option(hint_way_m, "hint_way_m", "m", "of way over which a find that waits says where to look next");
  }
};

}  // namespace isthmus
