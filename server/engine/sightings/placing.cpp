#include "server/engine/sightings/placing.hpp"

#include <optional>

namespace isthmus {
namespace {

Placing impossible(Reason reason) { return {Placing::State::impossible, reason}; }

Placing place_robot(const std::map<std::string, Robot>& robots, const std::string& name, std::int64_t utime,
                    bool waited, const OdometryNoiseOptions& noise, std::optional<PastPlace>& place) {
  const auto found = robots.find(name);
  if (found == robots.end()) return impossible(Reason::unknown_robot);
  const Robot& robot = found->second;
  if (!robot.history.empty() && robot.history.oldest_utime() > utime)
    return impossible(Reason::before_first_scan);
  place = robot.history.at(utime, robot.odometry, robot.noise, noise);
  if (place) return {};
  if (!waited) return {Placing::State::waits, Reason::none};
  if (robot.history.empty()) return impossible(Reason::before_first_scan);
  const bool is_ahead = robot.odometry.empty() || robot.odometry.newest_utime() < utime;
  return impossible(is_ahead ? Reason::stamp_in_future : Reason::no_pose_at_stamp);
}

}  // namespace

PastPlace place_of_tag(PatchId patch, std::int64_t utime) {
  return {utime, 0, {patch, Pose{}}, Eigen::Matrix3d::Zero(), Pose{}};
}

Placing place_on_manifold(const std::map<std::string, Robot>& robots,
                          const std::map<std::int32_t, PatchId>& tags, bool waited, Evidence& evidence,
                          const OdometryNoiseOptions& noise) {
  const std::int64_t utime = evidence.sighting.utime;
  std::optional<PastPlace> observer;
  const Placing placing = place_robot(robots, evidence.sighting.robot, utime, waited, noise, observer);
  if (placing.state != Placing::State::placed) return placing;
  evidence.observer = *observer;
  if (!evidence.is_tag)
    return place_robot(robots, evidence.target, utime, waited, noise, evidence.target_place);
  const auto tag = tags.find(evidence.sighting.barcode);
  if (tag != tags.end()) evidence.target_place = place_of_tag(tag->second, utime);
  return {};
}

}  // namespace isthmus
