#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "server/engine/record/map_copy.hpp"
#include "server/paths/ground/no_way.hpp"

namespace isthmus {

/// How far patches are from one another along relations: the least sum of the distances between the origins
/// of related patches, in metres. It bounds what two patches of one island can have drifted apart, and stands
/// for eq. 12 of Howard et al. 2006 where every pair of patches is asked about.
class NearPatches {
 public:
  /// A fit may move related patches so much against one another before ways are measured again.
  static constexpr float bent_m = 0.1F;

  NearPatches() = default;
  /// Ways of at most `reach_m` are known.
  NearPatches(const MapCopy& map, double reach_m);

  /// Of what the map has become since, for a fraction of the work where relations were only added.
  NearPatches kept_up(const MapCopy& map) const;

  /// no_way_m where it is more than the reach, and for patches that are not there.
  float way_m(PatchId a, PatchId b) const;
  bool near(PatchId a, PatchId b) const { return way_m(a, b) < no_way_m; }

  /// The pairs of patches of both that are near one another here and were not before, or the other way round;
  /// the lower id first, in order.
  std::vector<std::pair<PatchId, PatchId>> changes(const NearPatches& before) const;

 private:
  using Row = std::vector<std::pair<PatchId, float>>;  // by id

  void measure_all();
  void add_ways_by(PatchId patch);
  Row ways_from(PatchId start, std::vector<float>& way) const;

  float reach_m_ = 0;
  std::vector<Row> direct_;                       // between related patches, by patch id
  std::vector<std::shared_ptr<const Row>> near_;  // by patch id
};

}  // namespace isthmus
