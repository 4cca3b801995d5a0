#pragma once

#include "server/engine/localise/localise.hpp"
#include "server/engine/robot/robot_pose.hpp"

namespace isthmus {

/// What one scan did.
struct ScanOutcome {
  RobotPose pose;
  Unmatched unmatched = Unmatched::no;
  bool new_session = false;    ///< the robot began a new island with this scan
  bool unplaced = false;       ///< nothing tells yet where it was
  bool loop_closed = false;    ///< the island wants a fit as a whole
  bool patch_refused = false;  ///< it would have become a patch, had the robot not as many as it may have
};

/// Whether a robot has as many patches as it may have. What it shows from then on is no longer mapped, so
/// that no robot can fill the memory; it is localised by what there is, else by its odometry.
bool has_all_patches(const Robot& robot, const EngineOptions& options);
/// Such a robot without a place: it would need a first patch.
bool may_not_begin(const Robot& robot, const EngineOptions& options);

/// Incremental localisation and mapping (Howard et al. 2006, IV-A) of what one robot has seen in one scan;
/// its odometry at the scan's stamp is given. A robot with all its patches must have a place.
ScanOutcome take_scan(Map& map, Robot& robot, Observation observation, const Pose& odom_from_robot,
                      const EngineOptions& options);

}  // namespace isthmus
