#pragma once

#include <cstdint>
#include <tuple>

namespace isthmus {

/// What the search for hypotheses did.
struct HypothesisCounts {
  std::int64_t queries = 0;
  std::int64_t queries_put_off = 0;  ///< whose turn newer ones took, and that were asked when none waited
  std::int64_t places_searched = 0;
  std::int64_t ambiguous = 0;  ///< queries that fit two places about as well
  std::int64_t finds = 0;
  std::int64_t proposed = 0;

  auto members() { return std::tie(queries, queries_put_off, places_searched, ambiguous, finds, proposed); }
};

}  // namespace isthmus
