#pragma once

#include <string>
#include <tuple>

#include "patches/ids.hpp"
#include "patches/manifold.hpp"

namespace isthmus {

/// Where one robot is to stand at a meeting.
struct MeetingPlace {
  std::string robot;
  ManifoldPose pose;  ///< facing the other robot, if the hypothesis is true

  auto members() { return std::tie(robot, pose); }
};

/// A meeting of two robots that would settle a hypothesis.
struct MeetingRecord {
  ClosureId closure;  ///< the hypothesis
  MeetingPlace a;
  MeetingPlace b;
};

}  // namespace isthmus
