#pragma once

#include "server/engine/localise/mapper.hpp"

namespace isthmus {

/// Whether a robot was declared without a laser (its maximum range is 0).
bool has_no_laser(const Robot& robot);

/// One step of a robot without a laser: its pose follows odometry, and every so far it makes a patch, whose
/// free space is what its footprint swept since the last one. Such patches are related by odometry and
/// sightings alone. Nothing where the odometry is not due yet (10 Hz).
std::optional<ScanOutcome> take_odometry(Map& map, Robot& robot, const Pose& odom_from_robot,
                                         std::int64_t utime, const EngineOptions& options);

/// A patch at the end of a way: free where a disc has been moved along it. `patch_from_robot` are poses of
/// the way, the last one the origin.
PatchPtr make_swept_patch(PatchId id, const std::string& robot, std::int64_t utime, double radius_m,
                          const std::vector<Pose>& patch_from_robot, const FootprintOptions& options);

}  // namespace isthmus
