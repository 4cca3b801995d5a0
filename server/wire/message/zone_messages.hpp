#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "isthmus/zones_t.hpp"
#include "server/engine/record/map_copy.hpp"

namespace isthmus {

/// Writes a map's places and zones as an ISTHMUS_ZONES message. It remembers what it wrote last, so that only
/// changes need to be sent.
class ZoneMessages {
 public:
  /// A corner that moved by less than this since it was sent is not sent again; nor a place that turned by
  /// less than so many radians.
  static constexpr double still_m = 1e-3;
  static constexpr double still_rad = 1e-3;

  /// All; those that are lost are left out.
  zones_t whole(const MapCopy& map, std::int64_t utime);

  /// The same where something has changed since the last message, else nothing.
  std::optional<zones_t> changes(const MapCopy& map, std::int64_t utime);

 private:
  zones_t message(const MapCopy& map, std::int64_t utime);

  std::map<std::string, std::int32_t> ids_;  ///< by name, without case, of what is on the map or lost
  std::int32_t next_id_ = 0;
  zones_t sent_{};
};

}  // namespace isthmus
