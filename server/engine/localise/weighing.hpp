#pragma once

#include <optional>
#include <span>

#include "scanmatch/match.hpp"
#include "server/engine/localise/expectation.hpp"

namespace isthmus {

/// Squared distance in sigmas of a pose from where the robot was expected, where sigma is never smaller than
/// what matching itself errs by.
double surprise(const Pose& local_from_robot, const Expectation& expectation, const LocaliseOptions& options);

/// The scan held, along the direction in which a match took it away, where odometry puts the robot; nothing
/// where the match is likelier.
///
/// What moves along with a robot, a person or another robot, holds a match back while the walls of a corridor
/// do not object; wheels that slip look the same. The odds between the two: how much worse what stands,
/// things too large to move along, fits where odometry has the robot, how many other things would have had to
/// move along, and how far wheels that do not slip would have to be off. The held match says nothing of that
/// direction, and its score is that of what stands.
std::optional<Match> held_by_odometry(const LocalMap& local_map, std::span<const ScanPoint> points,
                                      const Expectation& expectation, const Match& match,
                                      const MatchOptions& match_options, const EngineOptions& options);

}  // namespace isthmus
