#pragma once

#include <tuple>
#include <vector>

#include "server/engine/sightings/mutual_observations.hpp"

namespace isthmus {

/// Gives fixed tags their places on the map: patches without extent. A tag that is nowhere yet is placed once
/// several sightings from one island agree on a point.
class TagPlacer {
 public:
  /// Places what the pool allows; sightings that have placed a tag are out of it then.
  void place(World world, MutualObservations& observations);
  /// Tags with too few relations left lose their places. `gone`: relations that are no longer in the map;
  /// the remaining relations of these tags are removed and added to it.
  void displace(Map& map, std::vector<Relation>& gone, const EvidenceOptions& options);

  const TagPatches& patches() const { return patches_; }

  auto members() { return std::tie(patches_); }

 private:
  bool place(World world, std::int32_t barcode, const std::vector<std::size_t>& members,
             MutualObservations& observations, std::set<std::size_t>& used);
  bool is_beside_another(World world, IslandId island, const PointConsensus& consensus) const;

  TagPatches patches_;
};

}  // namespace isthmus
