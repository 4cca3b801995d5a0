#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <tuple>
#include <vector>

#include "patches/pose.hpp"

namespace isthmus {

/// One robot's recent odometry in event order. Stamps may go back a little (lcmtypes/README.md).
///
/// It is asked by the stamps of all else that a robot says, which may be later than odometry's of the same
/// moment (ScanDelay).
class OdometryTrack {
 public:
  void add(std::int64_t utime, const Pose& odom_from_robot);
  void clear() { samples_.clear(); }
  bool empty() const { return samples_.empty(); }
  void set_delay_of_others(std::int64_t us) { delay_us_ = us; }
  std::int64_t newest_utime() const { return newest_own_utime() + delay_us_; }
  std::int64_t newest_own_utime() const { return samples_.back().utime; }  ///< by odometry's own stamps

  /// The odometry at a stamp: the last sample with exactly that stamp, else interpolated between the newest
  /// two successive samples that enclose it. Nothing while the stamp is newer than every sample, or where it
  /// is older than all that is kept.
  std::optional<Pose> at(std::int64_t utime) const { return at_own(utime - delay_us_); }
  /// The same, and beyond either end of what is kept the sample there; nothing where none is.
  std::optional<Pose> at_nearest(std::int64_t utime) const;
  /// The same as `at` at one of odometry's own stamps.
  std::optional<Pose> at_own(std::int64_t utime) const;

  /// Headings at so many of odometry's own stamps, each a step before the one before it; none where not all
  /// of them are kept.
  std::vector<double> own_yaws_back_from(std::int64_t utime, std::int64_t step_us, std::size_t count) const;

  /// The last sample as it stands.
  std::optional<Pose> newest() const;

  auto members() { return std::tie(samples_, delay_us_); }

 private:
  static constexpr std::size_t max_samples = 2000;

  struct Sample {
    std::int64_t utime = 0;
    Pose odom_from_robot;

    auto members() { return std::tie(utime, odom_from_robot); }
  };
  std::deque<Sample> samples_;
  std::int64_t delay_us_ = 0;
};

}  // namespace isthmus
