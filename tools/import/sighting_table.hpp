#pragma once

#include <string>
#include <vector>

#include "server/engine/input/event.hpp"

namespace isthmus {

/// Reads sightings.csv: `utime_us,observer,barcode,range_m,bearing_rad,range_std_m,bearing_std_rad`, in file
/// order. Sigmas may be `inf` (that part was not measured). With `skip_bad_lines` rows that cannot be read
/// are counted into `bad_lines`; otherwise they are a FileError.
std::vector<SightingEvent> read_sighting_table(const std::string& file, bool skip_bad_lines, long& bad_lines);

}  // namespace isthmus
