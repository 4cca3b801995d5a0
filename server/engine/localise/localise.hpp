#pragma once

#include <cstdint>
#include <optional>

#include "scanmatch/match.hpp"
#include "server/engine/localise/expectation.hpp"
#include "server/engine/localise/unmatched.hpp"
#include "server/engine/robot/robot.hpp"

namespace isthmus {

/// The result of matching a scan.
struct Placement {
  bool matched = false;
  Unmatched reason = Unmatched::no;  ///< why not
  Pose local_from_robot;
  Eigen::Matrix3d covariance;
  Eigen::Matrix3d tracking_covariance;
  Match match;
};

/// Fits a scan to the local map from where odometry puts it (Howard et al. 2006, IV-A, steps 3 and 4). Where
/// that fits badly, or far from where it was expected, other beginnings are tried: motion as before, no
/// motion, and a search whose window comes from the covariance.
Placement localise(const Robot& robot, const Expectation& expectation, const LocalMap& local_map,
                   std::span<const ScanPoint> points, const EngineOptions& options);

/// Whether a scan may well have been elsewhere than where it was matched, or was not matched at all.
bool is_doubtful(const Placement& placement, const LocaliseOptions& options);

/// Whether a scan fits another pose about as well as its best.
bool rivals(const Match& match, const Match& other, const EngineOptions& options);

/// Looks for a doubtful scan wherever the robot can be by now, at all headings that it can have turned to
/// since the last scan that was matched: odometry may have frozen, slipped, or lagged behind. `near`:
/// all that lies there, whether or not a scan from where odometry puts the robot would see it. Nothing where
/// the scan does not fit well, also where it fits two poses about as well.
std::optional<Placement> localise_anew(const Robot& robot, const Expectation& expectation,
                                       const LocalMap& near, std::span<const ScanPoint> points,
                                       std::int64_t utime, const EngineOptions& options);

}  // namespace isthmus
