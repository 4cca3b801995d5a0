#include "server/engine/localise/follow.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

// The patches that a scan was matched with, by id: those that explain it about as well as any. The map may
// have another layer of the same place that does not; what the robot sees says nothing of where that lies.
std::vector<PatchId> matched_patches(const LocalMap& local_map, const Match& match,
                                     const EngineOptions& options) {
  std::vector<double> weights(local_map.patches.size(), 0);
  for (const Pair& pair : match.pairs) weights[static_cast<std::size_t>(pair.patch)] += pair.weight;
  const double min_weight = options.surroundings.min_overlap * *std::ranges::max_element(weights);
  std::vector<PatchId> matched;
  for (std::size_t i = 0; i < weights.size(); ++i)
    if (weights[i] >= min_weight) matched.push_back(local_map.patches[i].patch->id);
  std::ranges::sort(matched);
  return matched;
}

// The patches that a robot may be put on: well determined and, where its scan was matched, with them.
std::vector<PatchId> grounds(const Robot& robot, const Placement& placement, const EngineOptions& options) {
  std::vector<PatchId> well_determined;
  for (const Determined& determined : robot.surroundings.patches())
    if (determined.well_determined) well_determined.push_back(determined.patch);
  if (placement.match.pairs.empty()) return well_determined;
  const std::vector<PatchId> matched = matched_patches(robot.local_map, placement.match, options);
  std::erase_if(well_determined, [&](PatchId id) { return !std::ranges::binary_search(matched, id); });
  return well_determined;
}

// Eq. 14: puts the robot on the nearest patch of its local map that it lies in. The present patch is kept
// until another is clearly nearer.
void project_on_manifold(const Map& map, Robot& robot, const Placement& placement,
                         const EngineOptions& options) {
  const PatchId present = robot.surroundings.reference();
  const Pose& local_from_robot = placement.local_from_robot;
  const ManifoldPose here{present, local_from_robot};
  ManifoldPose best = map.manifold()
                          .project_back(map.manifold().project(here), grounds(robot, placement, options))
                          .value_or(here);
  const auto distance = [](const Pose& r) { return std::hypot(r.x, r.y); };
  if (distance(best.patch_from_object) > distance(local_from_robot) - options.follow.clearly_nearer_m)
    best = here;

  Localisation& place = *robot.place;
  place.pose = best;
  const Pose present_from_best = map.relative_pose(present, best.patch);
  const Eigen::Matrix3d turn = ominus_jacobians(local_from_robot, present_from_best).by_q;
  place.covariance = turn * placement.covariance * turn.transpose();
  place.tracking_covariance = turn * placement.tracking_covariance * turn.transpose();
}

// How much farther ahead odometry would have the robot by the step to a stamp, were scans stamped later by a
// usual delay: what it said so much earlier, less what it says.
double farther_if_late_m(const Robot& robot, std::int64_t utime, const Pose& claimed_step,
                         const ScanDelayOptions& options) {
  const auto delay_us = static_cast<std::int64_t>(1e6 * options.sigma_s);
  const auto from = robot.odometry.at_nearest(robot.place->utime - delay_us);
  const auto to = robot.odometry.at_nearest(utime - delay_us);
  return from && to ? ominus(*to, *from).x - claimed_step.x : 0;
}

}  // namespace

void choose_local_map(const Map& map, Robot& robot, const Pose& local_from_robot,
                      std::span<const ScanPoint> points, const EngineOptions& options) {
  robot.surroundings.update(map, robot.place->pose.patch, options, Surroundings::By::scans);
  const Pose moved = ominus(local_from_robot, robot.local_map_centre);
  if (robot.local_map.reference == robot.surroundings.reference() &&
      robot.local_map_stamp == robot.surroundings.stamp() &&
      std::hypot(moved.x, moved.y) < options.follow.spacing_share * options.patch_spacing_m &&
      std::abs(moved.yaw) < options.follow.spacing_share * options.patch_spacing_rad) {
    return;
  }
  robot.local_map = robot.surroundings.local_map(map, local_from_robot, points, options);
  robot.local_map_centre = local_from_robot;
  robot.local_map_stamp = robot.surroundings.stamp();
}

void move_on(Robot& robot, const Expectation& expectation, const Placement& placement,
             const Pose& odom_from_robot, std::int64_t utime, const EngineOptions& options) {
  Localisation& place = *robot.place;
  const Pose matched_step = ominus(placement.local_from_robot, place.pose.patch_from_object);
  const bool step_is_seen = placement.matched || expectation.seen;
  const Pose told = robot.bias.corrected(expectation.claimed_step);
  if (step_is_seen && expectation.plausible) {
    robot.turn_error.learn(wrap_angle(matched_step.yaw - told.yaw),
                           robot.noise.covariance(told, options.odometry_noise)(2, 2),
                           options.odometry_noise);
  } else if (!step_is_seen) {
    robot.turn_error.go_on();
  }
  if (placement.matched && expectation.plausible && !place.suspect)
    robot.usual_misfit.learn(placement.match.quality.score, options.usual_misfit);
  if (placement.matched && expectation.plausible && !place.suspect && place.lost_scans == 0) {
    const double variance_rad2 =
        robot.noise.covariance(expectation.claimed_step, options.odometry_noise)(2, 2);
    robot.scan_delay.learn({place.utime, utime, matched_step.yaw, variance_rad2}, robot.odometry,
                           options.scan_delay, options.odometry_bias);
    // What odometry has yet to tell of a scan's moment is not waited for.
    robot.odometry.set_delay_of_others(std::max<std::int64_t>(0, robot.scan_delay.us()));
  }
  if (placement.matched && expectation.plausible && !expectation.catches_up) {
    const double yaw = place.pose.patch_from_object.yaw;
    const Eigen::Matrix2d local_from_step = Eigen::Rotation2Dd(yaw).toRotationMatrix();
    const Eigen::Matrix2d trust =
        local_from_step.transpose() * placement.match.direction_trust * local_from_step;
    robot.noise.learn(told, matched_step, trust, options.odometry_noise, options.odometry_learning);
    robot.bias.learn(expectation.claimed_step,
                     farther_if_late_m(robot, utime, expectation.claimed_step, options.scan_delay),
                     matched_step, robot.noise.covariance(told, options.odometry_noise), trust,
                     options.odometry_bias, options.odometry_learning);
  }
  if (placement.matched) {
    robot.health.matched(expectation.claimed_step, matched_step,
                         placement.match.direction_trust.determinant() > options.odometry_learning.well_known,
                         options.health);
  } else {
    robot.health.unmatched();
  }
  place.last_step = matched_step;
  if (!is_rest(expectation.claimed_step, options.odometry_learning)) {
    place.untold = {};
    place.last_told = matched_step;
  } else if (step_is_seen) {
    place.untold = place.untold * matched_step;
  }
  const double yaw_before = place.since_last_patch.start_from_end.yaw;
  place.append(expectation.is_known() ? expectation.step : matched_step, expectation.step_covariance);
  if (placement.matched)
    place.since_last_patch.face(yaw_before + matched_step.yaw, placement.tracking_covariance(2, 2));
  // The next step begins where odometry was at this scan by the delay as it is known now.
  place.odom_from_robot = robot.odometry.at(utime).value_or(odom_from_robot);
  place.utime = utime;
  place.suspect = placement.matched ? false : place.suspect || !expectation.is_known();
  place.lost_scans = placement.matched ? 0 : place.lost_scans + 1;
  place.unseen_steps = placement.matched ? 0 : place.unseen_steps + (expectation.seen ? 0 : 1);
}

void follow(const Map& map, Robot& robot, const Expectation& expectation, const Placement& placement,
            const Pose& odom_from_robot, std::int64_t utime, const EngineOptions& options) {
  move_on(robot, expectation, placement, odom_from_robot, utime, options);
  project_on_manifold(map, robot, placement, options);
}

RobotPose answer(const Map& map, const Robot& robot, bool matched) {
  const Localisation& place = *robot.place;
  RobotPose pose;
  pose.robot = robot.declaration.robot;
  pose.utime = place.utime;
  pose.island = map.graph().island(place.pose.patch);
  pose.pose = place.pose;
  pose.covariance = place.covariance;
  pose.map_from_robot = map.manifold().project(place.pose);
  pose.map_from_odom = pose.map_from_robot * inverse(place.odom_from_robot);
  pose.matched = matched;
  return pose;
}

}  // namespace isthmus
