#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <tuple>

#include "patches/pose.hpp"

namespace isthmus {

/// One robot's recent odometry in event order. Stamps may go back a little (lcmtypes/README.md).
class OdometryTrack {
 public:
  void add(std::int64_t utime, const Pose& odom_from_robot);
  void clear() { samples_.clear(); }
  bool empty() const { return samples_.empty(); }
  std::int64_t newest_utime() const { return samples_.back().utime; }

  /// The odometry at a stamp: the last sample with exactly that stamp, else interpolated between the newest
  /// two successive samples that enclose it. Nothing while the stamp is newer than every sample, or where it
  /// is older than all that is kept.
  std::optional<Pose> at(std::int64_t utime) const;

  /// The last sample as it stands.
  std::optional<Pose> newest() const;

  auto members() { return std::tie(samples_); }

 private:
  static constexpr std::size_t max_samples = 2000;

  struct Sample {
    std::int64_t utime = 0;
    Pose odom_from_robot;

    auto members() { return std::tie(utime, odom_from_robot); }
  };
  std::deque<Sample> samples_;
};

}  // namespace isthmus
