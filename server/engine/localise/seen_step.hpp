#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "server/engine/localise/expectation.hpp"

namespace isthmus {

/// Where a robot is expected by the step that a scan shows together with the one before it (Lu and Milios,
/// 1997, "Robot pose estimation in unknown environments by matching 2D range scans"). What the robot sees as
/// it comes round a corner is on ground that no patch has seen, but the scan before has; and wheels that
/// slip, or freeze, in that turn tell nothing of it.
///
/// The step is weighed against odometry as any match is, where that may err at random or, as it does while
/// wheels slip, on as it did (TurnError). Nothing where the two scans fit badly, or in two ways, or the one
/// before is not known.
std::optional<Expectation> expect_as_seen(const Robot& robot, const Pose& odom_from_robot,
                                          std::span<const ScanPoint> points, std::int64_t utime,
                                          const EngineOptions& options);

}  // namespace isthmus
