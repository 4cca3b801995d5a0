#include "server/engine/robot/pose_history.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace isthmus {
namespace {

// So many times as often as it fills, a history is thinned: each thinning looks at all of it.
constexpr std::size_t thinnings = 4;

// Places nearer than this to the one before them tell nothing new.
bool near_by(const PastPlace& a, const PastPlace& b, const PoseHistoryOptions& options) {
  const Pose step = ominus(b.odom_from_robot, a.odom_from_robot);
  return a.session == b.session && a.pose.patch == b.pose.patch && b.utime - a.utime < options.near_us &&
         std::hypot(step.x, step.y) < options.near_m &&
         std::abs(step.yaw) < options.common.yaw_rad(options.near_m);
}

PastPlace moved_on(const PastPlace& from, const Pose& step, const OdometryNoise& noise,
                   const OdometryNoiseOptions& noise_options, std::int64_t utime) {
  PastPlace place = from;
  const Pose& r = from.pose.patch_from_object;
  const ComposeJacobians j = compose_jacobians(r, step);
  place.utime = utime;
  place.pose.patch_from_object = r * step;
  place.odom_from_robot = from.odom_from_robot * step;
  place.covariance = j.by_left * from.covariance * j.by_left.transpose() +
                     j.by_right * noise.covariance(step, noise_options) * j.by_right.transpose();
  return place;
}

}  // namespace

void PoseHistory::add(const PastPlace& place, const PoseHistoryOptions& options) {
  // The newest is always kept; the one before it goes where it was near the one before that.
  if (places_.size() > 1 && places_.back().utime < place.utime &&
      near_by(places_[places_.size() - 2], place, options))
    places_.pop_back();
  auto after = places_.end();
  while (after != places_.begin() && std::prev(after)->utime > place.utime) --after;
  places_.insert(after, place);
  ++since_thinned_;
  if (places_.size() <= max_places) return;
  if (since_thinned_ >= max_places / thinnings) thin(options);
  if (places_.size() > max_places) places_.pop_front();
}

void PoseHistory::thin(const PoseHistoryOptions& options) {
  since_thinned_ = 0;
  std::deque<PastPlace> kept;
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const PastPlace& place = places_[i];
    const bool between = !kept.empty() && i + 1 < places_.size() && place.session == kept.back().session &&
                         place.session == places_[i + 1].session &&
                         places_[i + 1].utime - kept.back().utime <= options.near_us;
    if (!between || place.utime > places_.back().utime - options.newest_us) kept.push_back(place);
  }
  places_ = std::move(kept);
}

std::optional<PastPlace> PoseHistory::at(std::int64_t utime, const OdometryTrack& odometry,
                                         const OdometryNoise& noise,
                                         const OdometryNoiseOptions& noise_options) const {
  const auto after = std::upper_bound(places_.begin(), places_.end(), utime,
                                      [](std::int64_t time, const PastPlace& p) { return time < p.utime; });
  if (after == places_.begin()) return std::nullopt;
  const PastPlace& before = *std::prev(after);
  if (before.utime == utime) return before;
  if (after != places_.end() && after->session == before.session) {
    const Pose step = ominus(after->odom_from_robot, before.odom_from_robot);
    const double share =
        static_cast<double>(utime - before.utime) / static_cast<double>(after->utime - before.utime);
    return moved_on(before, {share * step.x, share * step.y, share * step.yaw}, noise, noise_options, utime);
  }
  const std::optional<Pose> odom_from_robot = odometry.at(utime);
  if (!odom_from_robot) return std::nullopt;
  return moved_on(before, ominus(*odom_from_robot, before.odom_from_robot), noise, noise_options, utime);
}

}  // namespace isthmus
