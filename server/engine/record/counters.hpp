#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <tuple>

#include "server/engine/input/drop_reason.hpp"
#include "server/engine/localise/unmatched.hpp"

namespace isthmus {

/// What the engine counted, from its first event on.
struct Counters {
  std::int64_t events = 0;
  std::int64_t scans = 0;
  std::int64_t scans_matched = 0;
  std::map<Unmatched, std::int64_t> scans_predicted;  ///< placed by odometry alone, and why
  std::int64_t sightings = 0;
  std::map<DropReason, std::int64_t> dropped;  ///< messages, and why
  std::map<std::string, std::map<DropReason, std::int64_t>> dropped_by_robot;
  std::int64_t first_receive_utime = 0;
  std::int64_t last_receive_utime = 0;

  auto members() {
    return std::tie(events, scans, scans_matched, scans_predicted, sightings, dropped, dropped_by_robot,
                    first_receive_utime, last_receive_utime);
  }
};

}  // namespace isthmus
