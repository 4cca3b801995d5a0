#pragma once

#include <cstdint>
#include <string>
#include <tuple>

#include "patches/ids.hpp"

namespace isthmus {

/// One run of a robot between restarts; its patches are on one island (until merges).
struct Session {
  std::string robot;
  std::int32_t number = 0;  ///< index among all sessions of all robots
  std::int64_t from_utime = 0;
  std::int64_t to_utime = 0;  ///< last scan so far
  PatchId first_patch;        ///< none while nothing was mapped

  auto members() { return std::tie(robot, number, from_utime, to_utime, first_patch); }
};

}  // namespace isthmus
