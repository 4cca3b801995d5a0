#include "patches/observation.hpp"

#include <utility>

namespace isthmus {

Observation observe(Scan scan, const Laser& laser, const PatchOptions& options) {
  Observation seen;
  seen.points = to_points(scan, laser, options.normals);
  seen.star = Star(scan, laser, options.free_space.max_range_m, options.free_space.no_return_range_m);
  seen.scan = std::move(scan);
  seen.laser = laser;
  return seen;
}

}  // namespace isthmus
