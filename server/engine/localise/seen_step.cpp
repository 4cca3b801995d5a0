#include "server/engine/localise/seen_step.hpp"

#include <memory>

#include "server/engine/localise/localise.hpp"
#include "server/engine/localise/weighing.hpp"

namespace isthmus {
namespace {

// A scan as the only patch of a map, where the robot was.
LocalMap map_of(const Robot& robot, const EngineOptions& options) {
  auto patch = std::make_shared<Patch>();
  static_cast<Observation&>(*patch) = observe(robot.last_scan, robot.declaration.laser, options.patch);
  patch->robot = robot.declaration.robot;
  patch->utime = robot.last_scan.utime;
  patch->index = PointIndex(patch->points);
  const ManifoldPose& was = robot.place->pose;
  return {was.patch, {{std::move(patch), was.patch_from_object}}};
}

// What errs from the scan before to this one is the step alone.
Expectation from_the_scan_before(const Robot& robot, const Expectation& expectation) {
  Expectation step = expectation;
  const Eigen::Matrix3d turn =
      compose_jacobians(robot.place->pose.patch_from_object, expectation.step).by_right;
  step.covariance = step.tracking_covariance = turn * expectation.step_covariance * turn.transpose();
  return step;
}

// Placed by the scan before as by any map: near where it is expected, or anew. Where the two fit badly, as
// amid legs of tables, what agrees with odometry is taken.
std::optional<Placement> placed_by(const LocalMap& before, const Robot& robot, const Expectation& step,
                                   std::span<const ScanPoint> points, std::int64_t utime,
                                   const EngineOptions& options) {
  const LocaliseOptions& its = options.localise;
  Placement placement = localise(robot, step, before, points, options);
  if (!is_doubtful(placement, its)) return placement;
  if (std::optional<Placement> anew = localise_anew(robot, step, before, points, utime, options)) return anew;
  if (placement.matched && surprise(placement.local_from_robot, step, its) < its.common.surprise.bound(3))
    return placement;
  return std::nullopt;
}

Expectation after(const Robot& robot, const Placement& seen, const Expectation& by_odometry) {
  const Localisation& place = *robot.place;
  const Pose& was = place.pose.patch_from_object;
  Expectation expectation = by_odometry;
  expectation.local_from_robot = seen.local_from_robot;
  expectation.step = ominus(seen.local_from_robot, was);
  expectation.seen = true;
  const ComposeJacobians jacobians = compose_jacobians(was, expectation.step);
  const Eigen::Matrix3d back = jacobians.by_right.transpose();  // a turn
  expectation.step_covariance = back * seen.covariance * back.transpose();
  const auto grown = [&](const Eigen::Matrix3d& before, const Eigen::Matrix3d& step) -> Eigen::Matrix3d {
    const Eigen::Matrix3d sum = jacobians.by_left * before * jacobians.by_left.transpose() + step;
    return 0.5 * (sum + sum.transpose());
  };
  expectation.covariance = grown(place.covariance, seen.covariance);
  expectation.tracking_covariance = grown(place.tracking_covariance, seen.tracking_covariance);
  return expectation;
}

}  // namespace

std::optional<Expectation> expect_as_seen(const Robot& robot, const Pose& odom_from_robot,
                                          std::span<const ScanPoint> points, std::int64_t utime,
                                          const EngineOptions& options) {
  if (robot.last_scan.utime != robot.place->utime) return std::nullopt;
  const LocalMap before = map_of(robot, options);
  for (const TurnErrors errors : {TurnErrors::at_random, TurnErrors::going_on}) {
    const Expectation by_odometry = expect(robot, odom_from_robot, utime, options, errors);
    const std::optional<Placement> seen =
        placed_by(before, robot, from_the_scan_before(robot, by_odometry), points, utime, options);
    if (seen) return after(robot, *seen, by_odometry);
  }
  return std::nullopt;
}

}  // namespace isthmus
