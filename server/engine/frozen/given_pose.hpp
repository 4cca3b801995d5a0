#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "patches/manifold.hpp"
#include "patches/scan.hpp"
#include "server/engine/frozen/lost_robot.hpp"
#include "server/engine/input/drop_reason.hpp"
#include "server/engine/input/engine_options.hpp"
#include "server/engine/input/event.hpp"
#include "server/engine/map/map.hpp"

namespace isthmus {

/// Where somebody says that a robot is on a finished map.
struct GivenPose {
  ManifoldPose pose;
  std::vector<Pose> or_at;              ///< in the same patch: elsewhere, as likely
  double sigma_m = 0;                   ///< of x and of y
  double sigma_rad = 0;                 ///< of the yaw
  std::optional<Pose> odom_from_robot;  ///< at that pose; none until a scan of the robot has come
  int tries_left = 0;                   ///< scans

  /// The robot has moved by so much.
  void move(const Pose& step);
};

/// The pose that was meant, on a patch of the map that is near. Why not: unknown_patch, off_the_map.
struct GivenPoseReading {
  std::optional<ManifoldPose> pose;
  DropReason refusal = DropReason::none;
};
GivenPoseReading read_given_pose(const InitialPoseEvent& event, const Map& map);

/// Where a scan fits best about a pose, or about one of several, within two standard deviations; nothing
/// where it fits badly, or two places about as well (`why`).
std::optional<ManifoldPose> search_about(const GivenPose& given, const Map& map,
                                         std::span<const ScanPoint> points, const EngineOptions& options,
                                         NotFound& why);

}  // namespace isthmus
