#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/engine/record/map_copy.hpp"
#include "server/paths/ground/near_patches.hpp"
#include "server/paths/ground/zones.hpp"
#include "server/paths/questions/path.hpp"

namespace isthmus {

/// Where robots drove, on the manifold: what retro-traversing is found from (Howard et al. 2006, I). Rows of
/// the trajectory are thinned as they come, to places that are `spacing_m` apart.
class DrivenWays {
 public:
  static constexpr double spacing_m = 0.2;
  /// Where a robot came by its own way again, so near, it may change over to it; the two patches must be that
  /// near along relations, so that both passages are known to be in one place. In metres.
  static constexpr double crossing_m = 0.3;
  static constexpr double crossing_near_m = 5;

  void update(const MapCopy& map);

  /// From where a robot was last to where it was at a time of its last session, or first after it (0: where
  /// that began), along what it has driven in that session: the shortest such way on which a robot of a
  /// radius comes into no keep-out zone. `near`, `zones`: of this map.
  Path back(const MapCopy& map, const NearPatches& near, const Zones& zones, const std::string& robot,
            std::int64_t to_utime, double radius_m) const;

 private:
  struct Place {
    std::int64_t utime = 0;
    ManifoldPose pose;
  };

  void add(const TrajectoryRow& row, const MapCopy& map);

  std::shared_ptr<const TrajectoryStore> trajectory_;
  std::size_t rows_ = 0;                               // that were looked at
  std::map<std::int32_t, std::vector<Place>> places_;  // by session; the last one is where the robot is
};

}  // namespace isthmus
