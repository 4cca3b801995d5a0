#pragma once

#include <cstddef>
#include <cstdint>
#include <tuple>

#include "server/features/fusion/rendezvous.hpp"

namespace isthmus {

/// Robots of two maps that certainly met, where the maps have no feature in common yet: how the second one
/// lies is then told by two bearings alone, and far from there nobody can say which of several walls beside
/// one another is seen. So the maps stay two, each with a mark where its robot stood, until they overlap.
struct OpenMeeting {
  int mark_1 = 0;  ///< in the first map
  int mark_2 = 0;
  RobotAlignment alignment;  ///< of the marks
  std::int32_t fusion = -1;  ///< that it would be
  std::size_t views = 0;     ///< of both maps when a common feature was last looked for

  auto members() { return std::tie(mark_1, mark_2, alignment, fusion, views); }
};

}  // namespace isthmus
