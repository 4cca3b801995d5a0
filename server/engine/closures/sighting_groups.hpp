#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include "server/engine/input/options/closure_options.hpp"
#include "server/engine/sightings/evidence.hpp"

namespace isthmus {

/// A time at which two, a robot and another or a tag, were near one another.
struct Encounter {
  std::string first;
  std::string second;        ///< in alphabetical order
  std::size_t sighting = 0;  ///< the first of them that waits, among all sightings

  auto operator<=>(const Encounter&) const = default;
  auto members() { return std::tie(first, second, sighting); }
};

struct IslandPair {
  IslandId older;
  IslandId younger;

  auto operator<=>(const IslandPair&) const = default;
  auto members() { return std::tie(older, younger); }
};

/// What ties sightings together: a loop is closed by those of one encounter, two islands are merged by all
/// between them. In the order in which they are looked at: loops by name, then merges by age.
using GroupKey = std::variant<Encounter, IslandPair>;

/// Sightings that may stand for one closure.
struct SightingGroup {
  GroupKey key;
  IslandId older;
  IslandId younger;                  ///< of a loop: the same
  std::vector<std::size_t> members;  ///< in the pool, by time

  bool is_merge() const { return older != younger; }
};

/// The groups of all sightings in a pool whose targets have places, by key.
std::vector<SightingGroup> groups_of(const Map& map, const std::vector<Evidence>& pool,
                                     const ClosureOptions& options);

/// Loops, by key, then merges by how many patches they would come to: to try one out costs about as much.
/// Where islands pair up, n merges cost n log n; where one takes in the others one by one, n².
std::vector<SightingGroup> smallest_merges_first(const Map& map, std::vector<SightingGroup> groups);

/// The sightings of a pool that are too many, or have waited too long without support.
std::set<std::size_t> superfluous(const std::vector<Evidence>& pool, const std::vector<SightingGroup>& groups,
                                  std::int64_t now_utime, const ClosureOptions& options);

}  // namespace isthmus
