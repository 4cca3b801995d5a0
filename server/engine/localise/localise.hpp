#pragma once

#include <cstdint>
#include <optional>

#include "scanmatch/match.hpp"
#include "server/engine/localise/unmatched.hpp"
#include "server/engine/robot/robot.hpp"

namespace isthmus {

/// Where a robot is expected at a scan, by its odometry (eq. 11).
struct Expectation {
  Pose local_from_robot;       ///< in the frame of the robot's patch
  Eigen::Matrix3d covariance;  ///< grown from the calibrated covariance
  Eigen::Matrix3d tracking_covariance;
  Pose step;              ///< odometry since the last scan, without its bias; none where that is implausible
  Pose claimed_step;      ///< what odometry said
  bool plausible = true;  ///< false: no robot moves like that
};
Expectation expect(const Robot& robot, const Pose& odom_from_robot, std::int64_t utime,
                   const EngineOptions& options);

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

/// Looks for a doubtful scan wherever the robot can be by now, at all headings that it can have turned to
/// since the last scan that was matched: odometry may have frozen, slipped, or lagged behind a turn. `near`:
/// all that lies there, whether or not a scan from where odometry puts the robot would see it. Nothing where
/// the scan does not fit well, or where it fits two poses about as well.
std::optional<Placement> localise_anew(const Robot& robot, const Expectation& expectation,
                                       const LocalMap& near, std::span<const ScanPoint> points,
                                       std::int64_t utime, const EngineOptions& options);

}  // namespace isthmus
