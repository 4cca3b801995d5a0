#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "server/engine/sightings/evidence.hpp"

namespace isthmus {

/// What came of placing a sighting on the manifold.
struct Placing {
  enum class State {
    placed,
    waits,       ///< for odometry and scans up to its time
    impossible,  ///< it never will be; `reason` says why
  };

  State state = State::placed;
  Reason reason = Reason::none;
};

/// Where a fixed tag is: in the origin of its own patch, at any time.
PastPlace place_of_tag(PatchId patch, std::int64_t utime);

/// Fills in where the observer was at the sighting's time, and the target: a robot likewise, a tag where its
/// patch is, if it has one. `tags`: by barcode. `waited`: no more data will come for it; what is
/// unknown of that time stays unknown.
Placing place_on_manifold(const std::map<std::string, Robot>& robots,
                          const std::map<std::int32_t, PatchId>& tags, bool waited, Evidence& evidence,
                          const OdometryNoiseOptions& noise);

}  // namespace isthmus
