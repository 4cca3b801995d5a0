#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/engine/input/event.hpp"
#include "tools/simulate/plan/random.hpp"

namespace isthmus {

/// In whose name a well-formed message that makes no sense is sent, and of what.
struct Unruly {
  std::string robot;
  /// Where they are the team's, its map is at their mercy; else none of them is told to anybody.
  std::vector<std::string> robots;
  std::vector<std::int32_t> barcodes;
  std::int64_t closures = 0;  ///< ids below this are given orders about
};

/// Well formed, and out of all order: a declaration with another laser, mount, range, barcode or a restart;
/// odometry that jumps; stamps of other times; scans of one beam or of thousands; sightings of anybody;
/// orders about whatever there is.
Event unruly_event(const Unruly& unruly, std::int64_t utime, Random& random);

}  // namespace isthmus
