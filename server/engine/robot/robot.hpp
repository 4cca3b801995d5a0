#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "server/engine/input/event.hpp"
#include "server/engine/map/local_loop.hpp"
#include "server/engine/map/surroundings.hpp"
#include "server/engine/robot/odometry_bias.hpp"
#include "server/engine/robot/odometry_noise.hpp"
#include "server/engine/robot/odometry_track.hpp"
#include "server/engine/robot/pose_history.hpp"
#include "server/engine/robot/robot_health.hpp"
#include "server/engine/robot/scan_delay.hpp"
#include "server/engine/robot/turn_error.hpp"
#include "server/engine/robot/usual_misfit.hpp"

namespace isthmus {

/// Odometry added up over several scans, with its covariance.
struct OdometryPath {
  Pose start_from_end;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();

  void append(const Pose& step, const Eigen::Matrix3d& step_covariance);
  /// Its end is turned so, as others than odometry know.
  void face(double yaw, double variance_rad2);

  auto members() { return std::tie(start_from_end, covariance); }
};

/// A turn as odometry tells it.
struct ToldTurn {
  double rad = 0;
  double variance_rad2 = 0;

  auto members() { return std::tie(rad, variance_rad2); }
};

/// Where a robot is on the manifold, after its last scan.
struct Localisation {
  ManifoldPose pose;
  /// Covariance of patch_from_robot, calibrated: what is published.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  /// Of the same, without the errors that successive matches with the same map have in common: what odometry
  /// has to bridge from scan to scan.
  Eigen::Matrix3d tracking_covariance = Eigen::Matrix3d::Zero();
  Pose odom_from_robot;
  Pose last_step;  ///< motion over the last scan period
  Pose last_told;  ///< the same over the last one in which odometry told any
  Pose untold;     ///< motion that scans showed while odometry stood still: it may yet tell it, all at once
  std::int64_t utime = 0;
  PatchId last_patch;  ///< the robot's newest own patch
  /// Odometry since that patch, turned as scans showed. Turns that odometry tells wrong or late bend a way on
  /// which every metre is right.
  OdometryPath since_last_patch;
  ToldTurn told_since_last_patch;  ///< what odometry by itself says of the turn since then
  int lost_scans = 0;              ///< unmatched in a row
  int unseen_steps = 0;            ///< of theirs, those that the scan before did not show either
  bool suspect = false;            ///< odometry did something implausible since the last match

  void append(const Pose& odometry_step, const Eigen::Matrix3d& step_covariance);  ///< to the way

  auto members() {
    return std::tie(pose, covariance, tracking_covariance, odom_from_robot, last_step, last_told, untold,
                    utime, last_patch, since_last_patch, told_since_last_patch, lost_scans, unseen_steps,
                    suspect);
  }
};

/// A scan that was neither matched nor plausibly predicted: where the robot was is known once it is found
/// again, by its odometry backwards from there.
struct UnplacedScan {
  std::int64_t utime = 0;
  Pose odom_from_robot;

  auto members() { return std::tie(utime, odom_from_robot); }
};

/// Another robot where this one last saw it.
struct SeenTeammate {
  std::int64_t utime = 0;
  Eigen::Vector2d odom_position = Eigen::Vector2d::Zero();  ///< in this robot's odometry frame
  double sigma_m = 0;

  auto members() { return std::tie(utime, odom_position, sigma_m); }
};

struct PendingScan {
  Scan scan;
  std::int64_t receive_utime = 0;

  auto members() { return std::tie(scan, receive_utime); }
};

/// What the engine keeps of one robot.
struct Robot {
  RobotEvent declaration;
  bool declared = false;
  OdometryTrack odometry;
  OdometryNoise noise;
  OdometryBias bias;
  TurnError turn_error;  ///< beyond that
  UsualMisfit usual_misfit;
  ScanDelay scan_delay;
  RobotHealth health;
  std::deque<PendingScan> pending;  ///< scans that wait for odometry
  Scan last_scan;                   ///< where `place` is: ground that no patch may have seen
  std::optional<Localisation> place;
  std::int32_t session = -1;
  Surroundings surroundings;
  LocalMap local_map;
  Pose local_map_centre;  ///< local_from_robot that the local map was chosen for
  std::int64_t local_map_stamp = -1;
  std::int64_t last_scan_utime = 0;
  std::int64_t newest_scan_utime = 0;
  WaitingLoops local_loops;
  std::vector<UnplacedScan> unplaced;
  PoseHistory history;
  std::vector<Pose> way;  ///< of one without a laser: odometry since its last patch; empty: it had one
  std::map<std::string, SeenTeammate> seen;  ///< by name
  PatchId first_patch;                       ///< of its first session
  int stale_scans = 0;                       ///< in a row
  std::size_t patches = 0;                   ///< that it has added to the map

  auto members() {
    return std::tie(declaration, declared, odometry, noise, bias, turn_error, usual_misfit, scan_delay,
                    health, pending, last_scan, place, session, surroundings, local_map, local_map_centre,
                    local_map_stamp, last_scan_utime, newest_scan_utime, local_loops, unplaced, history, way,
                    seen, first_patch, stale_scans, patches);
  }
};

}  // namespace isthmus
