#pragma once

#include <cstdint>
#include <tuple>

namespace isthmus {

/// What the search for hypotheses did.
struct HypothesisCounts {
  std::int64_t queries = 0;
  std::int64_t queries_dropped = 0;  ///< that never got their turn
  std::int64_t places_searched = 0;
  std::int64_t ambiguous = 0;  ///< queries that fit two places about as well
  std::int64_t finds = 0;
  std::int64_t proposed = 0;

  auto members() { return std::tie(queries, queries_dropped, places_searched, ambiguous, finds, proposed); }
};

}  // namespace isthmus
