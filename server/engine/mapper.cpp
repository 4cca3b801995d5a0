#include "server/engine/mapper.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "server/engine/extend.hpp"

namespace isthmus {
namespace {

/// After so many lost scans following implausible odometry, the robot is somewhere else: a new session.
constexpr int most_lost_scans = 8;
/// Local maps are chosen anew when the robot has moved so far.
constexpr double reselect_m = 0.4;
constexpr double reselect_rad = 0.3;

void choose_local_map(const Map& map, Robot& robot, const Pose& local_from_robot,
                      std::span<const ScanPoint> points, const EngineOptions& options) {
  robot.surroundings.update(map, robot.place->pose.patch, options, Surroundings::By::scans);
  const Pose moved = ominus(local_from_robot, robot.local_map_centre);
  if (robot.local_map.reference == robot.surroundings.reference() &&
      robot.local_map_stamp == robot.surroundings.stamp() && std::hypot(moved.x, moved.y) < reselect_m &&
      std::abs(moved.yaw) < reselect_rad) {
    return;
  }
  robot.local_map = robot.surroundings.local_map(map, local_from_robot, points, options);
  robot.local_map_centre = local_from_robot;
  robot.local_map_stamp = robot.surroundings.stamp();
}

// Eq. 14: puts the robot on the nearest patch of its local map that it lies in. The present patch is kept
// until another is clearly nearer.
void project_on_manifold(const Map& map, Robot& robot, const Placement& placement) {
  constexpr double clearly_nearer_m = 0.2;
  const PatchId present = robot.surroundings.reference();
  const Pose& local_from_robot = placement.local_from_robot;
  std::vector<PatchId> firm;
  for (const Determined& determined : robot.surroundings.patches()) {
    if (determined.firm) firm.push_back(determined.patch);
  }
  const ManifoldPose here{present, local_from_robot};
  ManifoldPose best = map.manifold().project_back(map.manifold().project(here), firm).value_or(here);
  const auto distance = [](const Pose& r) { return std::hypot(r.x, r.y); };
  if (distance(best.patch_from_object) > distance(local_from_robot) - clearly_nearer_m) best = here;

  Localisation& place = *robot.place;
  place.pose = best;
  const Pose present_from_best = ominus(map.manifold().pose(best.patch), map.manifold().pose(present));
  const Eigen::Matrix3d turn = ominus_jacobians(local_from_robot, present_from_best).by_q;
  place.covariance = turn * placement.covariance * turn.transpose();
  place.spread = turn * placement.spread * turn.transpose();
}

// Moves the robot's place on to the scan (eqs. 13, 14).
void settle(const Map& map, Robot& robot, const Expectation& expectation, const Placement& placement,
            const Pose& odom_from_robot, std::int64_t utime) {
  Localisation& place = *robot.place;
  const Pose matched_step = ominus(placement.local_from_robot, place.pose.patch_from_object);
  if (placement.matched && expectation.plausible) {
    const double yaw = place.pose.patch_from_object.yaw;
    const Eigen::Matrix2d local_from_step = Eigen::Rotation2Dd(yaw).toRotationMatrix();
    robot.noise.learn(expectation.step, matched_step,
                      local_from_step.transpose() * placement.match.direction_trust * local_from_step);
  }
  if (placement.matched) {
    robot.health.matched(expectation.claimed_step, matched_step,
                         placement.match.direction_trust.determinant() > 0.8);
  } else {
    robot.health.unmatched();
  }
  place.last_step = matched_step;
  place.since_last_patch.append(expectation.plausible ? expectation.step : matched_step,
                                robot.noise.covariance(expectation.step));
  place.odom_from_robot = odom_from_robot;
  place.utime = utime;
  place.suspect = placement.matched ? false : place.suspect || !expectation.plausible;
  place.lost_scans = placement.matched ? 0 : place.lost_scans + 1;
  project_on_manifold(map, robot, placement);
}

// An unmatched scan becomes a patch only where the robot has left its surroundings behind: odometry alone
// joins it.
bool worth_a_patch_unmatched(const Robot& robot, const Placement& placement,
                             std::span<const ScanPoint> points, const EngineOptions& options) {
  const Pose& path = robot.place->since_last_patch.start_from_end;
  return !robot.place->suspect && placement.reason != "few_returns" &&
         static_cast<int>(points.size()) >= 2 * options.match.min_pairs && robot.place->lost_scans >= 3 &&
         (std::hypot(path.x, path.y) > 0.4 * options.patch_spacing_m ||
          std::abs(path.yaw) > 0.4 * options.patch_spacing_rad);
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

}  // namespace

bool has_all_patches(const Robot& robot, const EngineOptions& options) {
  return robot.patches >= options.patches_per_robot;
}

bool may_not_begin(const Robot& robot, const EngineOptions& options) {
  return !robot.place && has_all_patches(robot, options);
}

ScanOutcome take_scan(Map& map, Robot& robot, const Scan& scan, const Pose& odom_from_robot,
                      const EngineOptions& options) {
  const Laser& laser = robot.declaration.laser;
  const std::vector<ScanPoint> points = to_points(scan, laser, options.patch.normals);
  if (!robot.place) {
    begin_island(map, robot, scan, odom_from_robot, options);
    return {answer(map, robot, true), {}, true};
  }
  const bool full = has_all_patches(robot, options);
  const Expectation expectation = expect(robot, odom_from_robot, scan.utime);
  choose_local_map(map, robot, expectation.local_from_robot, points, options);
  const Placement placement = place(robot, expectation, robot.local_map, points, options);
  if (!placement.matched && (robot.place->suspect || !expectation.plausible) &&
      robot.place->lost_scans + 1 >= most_lost_scans && !full) {
    robot.health.unmatched();
    begin_island(map, robot, scan, odom_from_robot, options);
    return {answer(map, robot, true), {}, true};
  }
  settle(map, robot, expectation, placement, odom_from_robot, scan.utime);
  const Star star(scan, laser, options.patch.free_space.max_range_m,
                  options.patch.free_space.no_return_range_m);
  const bool worth_it = placement.matched ? worth_a_patch(map, robot.surroundings, placement, star, options)
                                          : worth_a_patch_unmatched(robot, placement, points, options);
  const bool loop = worth_it && !full && extend(map, robot, scan, placement, points, options);
  ScanOutcome outcome{answer(map, robot, placement.matched), placement.reason};
  outcome.unplaced = robot.place->suspect && !full;
  outcome.loop_closed = loop;
  outcome.patch_refused = worth_it && full;
  return outcome;
}

}  // namespace isthmus
