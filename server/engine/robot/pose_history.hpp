#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <tuple>

#include "patches/manifold.hpp"
#include "server/engine/robot/odometry_noise.hpp"
#include "server/engine/robot/odometry_track.hpp"

namespace isthmus {

/// Where a robot was at some time, on the manifold.
struct PastPlace {
  std::int64_t utime = 0;
  std::int32_t session = 0;
  ManifoldPose pose;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of patch_from_robot
  Pose odom_from_robot;

  auto members() { return std::tie(utime, session, pose, covariance, odom_from_robot); }
};

/// Where one robot was, for sightings, which carry a stamp of their own and may come late. Poses are on the
/// manifold, so that fits carry them along. A robot at rest adds next to nothing. Where it is full, what lies
/// between places 0.4 s apart goes, then the oldest: of a robot that scans fast twenty minutes are known.
class PoseHistory {
 public:
  void add(const PastPlace& place, const PoseHistoryOptions& options);
  bool empty() const { return places_.empty(); }
  std::int64_t oldest_utime() const { return places_.front().utime; }

  /// The place at a stamp: the last one known before it, moved on by odometry. Nothing where the robot was
  /// not on the map then, or where odometry does not reach.
  std::optional<PastPlace> at(std::int64_t utime, const OdometryTrack& odometry, const OdometryNoise& noise,
                              const OdometryNoiseOptions& noise_options) const;

  /// Changes where the robot was, but not when.
  void correct(const std::function<void(PastPlace&)>& place) { std::ranges::for_each(places_, place); }

  auto members() { return std::tie(places_, since_thinned_); }

 private:
  void thin(const PoseHistoryOptions& options);

  static constexpr std::size_t max_places = 4000;
  std::deque<PastPlace> places_;   // by utime
  std::size_t since_thinned_ = 0;  // places added
};

}  // namespace isthmus
