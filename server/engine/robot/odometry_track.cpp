#include "server/engine/robot/odometry_track.hpp"

#include <algorithm>

namespace isthmus {
namespace {

Pose interpolate(const Pose& from, const Pose& to, double share) {
  const Pose step = ominus(to, from);
  return from * Pose{share * step.x, share * step.y, share * step.yaw};
}

}  // namespace

void OdometryTrack::add(std::int64_t utime, const Pose& odom_from_robot) {
  samples_.push_back({utime, odom_from_robot});
  if (samples_.size() > max_samples) samples_.pop_front();
}

std::optional<Pose> OdometryTrack::newest() const {
  if (samples_.empty()) return std::nullopt;
  return samples_.back().odom_from_robot;
}

std::optional<Pose> OdometryTrack::at(std::int64_t utime) const {
  const Sample* after = nullptr;
  for (auto sample = samples_.rbegin(); sample != samples_.rend(); ++sample) {
    if (sample->utime == utime) return sample->odom_from_robot;
    if (after && sample->utime < utime && utime < after->utime) {
      const double share =
          static_cast<double>(utime - sample->utime) / static_cast<double>(after->utime - sample->utime);
      return interpolate(sample->odom_from_robot, after->odom_from_robot, share);
    }
    after = &*sample;
    constexpr std::int64_t backward_limit = 2'000'000;  // stamps of a robot go back by 1 s at most
    if (sample->utime < utime - backward_limit) break;
  }
  return std::nullopt;
}

}  // namespace isthmus
