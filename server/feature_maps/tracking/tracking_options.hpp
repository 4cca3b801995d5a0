#pragma once

#include <cstddef>

namespace isthmus {

/// Of a way by scans, see scan_tracker.hpp.
struct TrackingOptions {
  double place_every_m = 0.4;    ///< m and rad between the scans that others are placed on: nearer ones say
  double place_every_rad = 0.4;  ///< the same again
  std::size_t max_places = 8;    ///< the last ones: what lies farther back is the map's to tell
  double looked_along_m = 0.3;   ///< either way along the direction that a match knows least, for what fits
                                ///< as well there: a door frame's width, beyond which it is the map's to tell
};

}  // namespace isthmus
