#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "server/engine/places/place_search.hpp"

namespace isthmus {

/// How two finds lie to one another, once the loop that they make together has been gone round: from the
/// one's anchor to the other's over the map, back by the other find, and home over the map again.
enum class Agreement {
  unrelated,     ///< the map does not tell how their ends lie to each other
  consistent,    ///< the loop closes as well as its parts are known
  inconsistent,  ///< it does not: at least one is false
};

/// What the map says of one patch relative to those near it.
struct NearbyConfidence {
  PatchId reference;
  std::map<PatchId, Eigen::Matrix3d> covariances;

  NearbyConfidence(const Map& map, PatchId of, std::size_t max_patches);
  /// Nothing where the patch is not near.
  std::optional<Eigen::Matrix3d> of(PatchId patch) const;
};

/// `of_anchor` and `of_query` are of the first find's.
Agreement agreement(const Map& map, const Find& first, const NearbyConfidence& of_anchor,
                    const NearbyConfidence& of_query, const Find& second, const ConsistencyOptions& options);

/// Pairwise agreements of a number of things, and what they come to (pairwise consistency maximisation,
/// Mangelson et al. 2018).
class AgreementTable {
 public:
  std::size_t size() const { return rows_.size(); }
  /// A new member with its agreements with those there are.
  void add(std::vector<Agreement> with_earlier);
  /// A member is another thing from here on, with its agreements with all (with itself: any).
  void replace(std::size_t member, const std::vector<Agreement>& with_others);
  /// Members for which `gone` says yes leave; the others close up.
  void remove(const std::vector<bool>& gone);
  Agreement between(std::size_t a, std::size_t b) const;

  /// The largest set that is consistent pairwise and holds a member; the first in order of the members of
  /// equal ones. The search is cut off after a fixed number of steps, with the best so far.
  std::vector<std::size_t> largest_consistent_with(std::size_t member,
                                                   const ConsistencyOptions& options) const;
  /// Those that are inconsistent with most of a set.
  std::vector<std::size_t> rivals_of(const std::vector<std::size_t>& set) const;

  auto members() { return std::tie(rows_); }

 private:
  std::vector<std::vector<Agreement>> rows_;  // of each with those before it
};

}  // namespace isthmus
