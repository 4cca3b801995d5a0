#pragma once

#include <cstdint>
#include <deque>
#include <tuple>
#include <vector>

#include "server/engine/input/options/robot_options.hpp"
#include "server/engine/robot/odometry_track.hpp"

namespace isthmus {

/// How far a robot turned from one scan to the next, by both matches.
struct MatchedTurn {
  std::int64_t from_utime = 0, to_utime = 0;  ///< stamps of the scans
  double rad = 0;
  double variance_rad2 = 0;  ///< of what odometry says of it, at random

  auto members() { return std::tie(from_utime, to_utime, rad, variance_rad2); }
};

/// By how much a robot's scans are stamped later than what its odometry says of the same moment, learned on
/// line. A driver stamps a scan as it comes in, or an odometer tells what its controller will have done: of
/// five recorded robots three have scans that are 0.12 to 0.64 s late, the same throughout the drive. Left
/// in, odometry is wrong by all that a robot turns in this time, whenever it begins to turn or ends.
///
/// Temporal calibration by correlating turns (Mair et al. 2011, "Spatio-temporal initialization for IMU to
/// camera registration"): of each delay in a grid, the likelihood of what odometry told of all matched turns
/// is kept, under Cauchy's distribution, as wheels that slip err by much. Before anything is known, it is as
/// probable that there is no delay as that there is one, which is normal about none. Until a delay is the
/// more probable there is none, so that stamps that are right stay as they are; then it is the mean of what
/// is known.
class ScanDelay {
 public:
  /// Microseconds; negative where odometry is late.
  std::int64_t us() const { return us_; }

  /// A turn is weighed once odometry goes on far enough beyond it. Of matches as much is known, and of turns
  /// as long remembered, as for the odometry's bias.
  void learn(const MatchedTurn& turn, const OdometryTrack& odometry, const ScanDelayOptions& options,
             const OdometryBiasOptions& as_bias);

  auto members() { return std::tie(log_likelihoods_, waiting_, us_); }

 private:
  void weigh(const MatchedTurn& turn, const OdometryTrack& odometry, const ScanDelayOptions& options,
             const OdometryBiasOptions& as_bias);

  std::vector<double> log_likelihoods_;  // of the delays, from the least on
  std::deque<MatchedTurn> waiting_;
  std::int64_t us_ = 0;
};

}  // namespace isthmus
