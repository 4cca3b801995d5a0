#pragma once

#include <deque>
#include <optional>
#include <tuple>

#include "server/engine/input/engine_options.hpp"
#include "server/engine/robot/robot.hpp"
#include "server/feature_maps/tracking/tracking_options.hpp"

namespace isthmus {

/// Where a robot went from one scan to the next.
struct TrackedStep {
  Pose from_last;  ///< the pose at this scan in that of the last one
  Eigen::Matrix3d covariance =
      Eigen::Matrix3d::Zero();  ///< of its (x, y, yaw), in the frame of the last one (m², m rad, rad²)
  bool matched = false;         ///< by scans; odometry alone otherwise
};

/// A robot's way by its scans: each is placed by the engine's scan tracking (server/engine/localise), not on
/// a manifold but on the last few scans of the robot itself, kept one a place. So odometry is believed or a
/// match is, by how likely either is (its noise with the tails of slips against how much worse the scan fits
/// where odometry has it). A step is told by both together, by the match alone where wheels slipped, and by
/// odometry alone where no scan tells, along a corridor say. Deterministic.
class ScanTracker {
 public:
  ScanTracker() = default;
  explicit ScanTracker(const OdometryNoiseOptions& noise) : noise_(noise) {}

  /// The next scan, with odometry at its stamp. Nothing of the first.
  std::optional<TrackedStep> take(const Scan& scan, const Laser& laser, const Pose& odom_from_robot,
                                  const EngineOptions& options, const TrackingOptions& tracking);

  const OdometryNoise& noise() const { return noise_; }

  /// A scan that others are placed on.
  struct Place {
    Scan scan;
    Laser laser;
    Pose way_from_robot;  ///< in the frame of the first scan of the way

    auto members() { return std::tie(scan, laser, way_from_robot); }
  };

  /// All that changes, for snapshots (feature_snapshot.cpp); `restore` makes of the places what scans are
  /// placed on.
  auto changing() { return std::tie(place_, noise_, places_); }
  void restore(const EngineOptions& options);

 private:
  void keep(const Observation& seen, const TrackingOptions& tracking);

  std::optional<Localisation> place_;
  OdometryNoise noise_;
  std::deque<Place> places_;
  LocalMap local_map_;  ///< of the places
};

}  // namespace isthmus
