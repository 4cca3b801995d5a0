#pragma once

#include "server/engine/engine.hpp"
#include "server/engine/localise.hpp"

namespace isthmus {

/// What one scan did.
struct ScanOutcome {
  RobotPose pose;
  std::string predicted_reason;  ///< why it was not matched; empty where it was
  bool new_session = false;      ///< the robot began a new island with this scan
  bool unplaced = false;         ///< nothing tells yet where it was
  bool loop_closed = false;      ///< the island wants a fit as a whole
};

/// Incremental localisation and mapping (seed 001, IV-A) of one scan of one robot, whose odometry at the
/// scan's stamp is given.
ScanOutcome take_scan(Map& map, Robot& robot, const Scan& scan, const Pose& odom_from_robot,
                      const EngineOptions& options);

}  // namespace isthmus
