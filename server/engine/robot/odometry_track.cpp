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

std::optional<Pose> OdometryTrack::at_nearest(std::int64_t utime) const {
  if (samples_.empty()) return std::nullopt;
  if (const std::optional<Pose> found = at(utime)) return found;
  return (utime < newest_utime() ? samples_.front() : samples_.back()).odom_from_robot;
}

std::optional<Pose> OdometryTrack::at_own(std::int64_t utime) const {
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

std::vector<double> OdometryTrack::own_yaws_back_from(std::int64_t utime, std::int64_t step_us,
                                                      std::size_t count) const {
  std::vector<double> yaws;
  const Sample* after = nullptr;
  for (auto sample = samples_.rbegin(); sample != samples_.rend() && yaws.size() < count; ++sample) {
    while (sample->utime <= utime && yaws.size() < count) {
      if (!after && sample->utime < utime) return {};  // newer than all
      if (sample->utime == utime) {
        yaws.push_back(sample->odom_from_robot.yaw);
      } else {
        const double share =
            static_cast<double>(utime - sample->utime) / static_cast<double>(after->utime - sample->utime);
        yaws.push_back(interpolate(sample->odom_from_robot, after->odom_from_robot, share).yaw);
      }
      utime -= step_us;
    }
    after = &*sample;
  }
  return yaws.size() < count ? std::vector<double>{} : yaws;
}

}  // namespace isthmus
