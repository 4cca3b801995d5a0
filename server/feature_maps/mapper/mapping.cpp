// How a FeatureMapper maps: odometry and scans, on the map that a robot is on.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "server/feature_maps/mapper/feature_mapper.hpp"

namespace isthmus {
namespace {

/// Whether a point of the robot's frame lies well within what the scan saw free.
class FreeInScan {
 public:
  FreeInScan(const Scan& scan, const Laser& laser)
      : scan_(scan), laser_(laser), laser_from_robot_(inverse(laser.robot_from_laser)) {}

  bool operator()(const Eigen::Vector2d& point) const {
    constexpr double margin_m = 0.3;
    const Eigen::Vector2d seen = laser_from_robot_ * point;
    const double bearing = std::atan2(seen.y(), seen.x()) - scan_.bearing0_rad;
    const double beam = std::round(wrap_angle(bearing) / scan_.bearing_step_rad);
    for (const double turn : {0.0, 2 * std::numbers::pi / std::abs(scan_.bearing_step_rad)}) {
      const double index = beam + turn;
      if (index < 0 || index >= static_cast<double>(scan_.ranges_m.size())) continue;
      const float range = scan_.ranges_m[static_cast<std::size_t>(index)];
      return classify(range, laser_) == BeamKind::hit && seen.norm() + margin_m < range;
    }
    return false;
  }

 private:
  const Scan& scan_;
  const Laser& laser_;
  Pose laser_from_robot_;
};

std::vector<FeatureView> seen_by(const FeatureScanOutcome& outcome, std::span<const ObservedFeature> seen) {
  std::vector<FeatureView> views;
  for (const auto* pairs : {&outcome.paired, &outcome.added})
    for (const FeatureScanOutcome::Pair& pair : *pairs)
      views.push_back({pair.id, pair.line_alone, seen[pair.seen]});
  return views;
}

}  // namespace

void FeatureMapper::begin_journey(FeatureRobot& robot, const Pose& odom_from_robot) {
  Team team{FeatureFilter(options_.filter), {static_cast<int>(journeys_.size())}, {}};
  team.filter.add_robot({}, Eigen::Matrix3d::Zero());
  robot.journey = static_cast<int>(journeys_.size());
  robot.odom_from_last = robot.odom_from_robot = odom_from_robot;
  robot.tracker = ScanTracker(options_.engine.odometry_noise);
  robot.since_tracked = robot.since_stop = {};
  robot.way_m = options_.observe_every_m;  // its first scan is used
  journeys_.push_back({robot.declared.robot, static_cast<int>(teams_.size()), 0, {}, {}, {}});
  teams_.push_back(std::move(team));
}

void FeatureMapper::note_way(FeatureRobot& robot, const Pose& odom_from_robot) {
  const Pose step = ominus(odom_from_robot, robot.odom_from_robot);
  robot.odom_from_robot = odom_from_robot;
  robot.way_m += std::hypot(step.x, step.y);
  robot.turn_rad += std::abs(step.yaw);
}

/// Its filter moves on to the last input, by odometry.
void FeatureMapper::move_by_odometry(FeatureRobot& robot) {
  const Pose step = ominus(robot.odom_from_robot, robot.odom_from_last);
  robot.odom_from_last = robot.odom_from_robot;
  if (step == Pose{}) return;
  const Eigen::Matrix3d covariance = robot.tracker.noise().covariance(step, options_.engine.odometry_noise);
  const Journey& own = journey(robot);
  team_of(own).filter.move(own.member, step, covariance);
  robot.since_tracked.append(step, covariance);
  robot.since_stop.append(step, covariance);
}

/// The same by the scan there.
void FeatureMapper::move_by_scan(FeatureRobot& robot, const Scan& scan) {
  const std::optional<TrackedStep> tracked = robot.tracker.take(
      scan, robot.declared.laser, robot.odom_from_robot, options_.engine, options_.tracking);
  if (tracked) {
    // Where a part of the way was odometry's already, what that erred by is made good.
    const OdometryPath& told = robot.since_tracked;
    const OminusJacobians by = ominus_jacobians(tracked->from_last, told.start_from_end);
    const Journey& own = journey(robot);
    const Pose rest = ominus(tracked->from_last, told.start_from_end);
    const Eigen::Matrix3d covariance = by.by_q * tracked->covariance * by.by_q.transpose() +
                                       by.by_pi * told.covariance * by.by_pi.transpose();
    team_of(own).filter.move(own.member, rest, covariance);
    if (robot.since_stop.start_from_end == told.start_from_end)  // its last stop was at the last scan
      robot.since_stop = {tracked->from_last, tracked->covariance};
    else
      robot.since_stop.append(rest, covariance);
    robot.odom_from_last = robot.odom_from_robot;
    counts_.scans_tracked += tracked->matched ? 1 : 0;
  } else {
    move_by_odometry(robot);
  }
  robot.since_tracked = {};
}

/// Whether it was seen from where no scan was used before.
bool FeatureMapper::observe(FeatureRobot& robot, const Scan& scan, std::int64_t utime) {
  if (options_.kind != FeatureMapKind::segments) return false;
  if (robot.way_m < options_.observe_every_m && robot.turn_rad < options_.observe_every_rad) return false;
  robot.way_m = robot.turn_rad = 0;
  move_by_scan(robot, scan);
  std::vector<ObservedFeature> seen;
  for (const ScanSegment& segment :
       find_features(scan, robot.declared.laser, options_.scan_features).segments)
    seen.push_back(segment.observed);
  const Journey& own = journey(robot);
  FeatureFilter& filter = team_of(own).filter;
  const FeatureScanOutcome outcome = filter.observe(own.member, seen);
  FeatureScanOutcome still_there = outcome;  // a laser sees no barcode, and past one that hangs in the open
  for (const auto& [barcode, id] : team_of(own).landmarks) still_there.paired.push_back({0, id});
  const std::vector<int> gone =
      filter.contradict(own.member, still_there, FreeInScan(scan, robot.declared.laser));
  robot.matched = !outcome.paired.empty();
  stop(robot, utime, seen_by(outcome, seen));
  ++counts_.scans_used;
  counts_.segments_seen += static_cast<std::int64_t>(seen.size());
  counts_.segments_paired += static_cast<std::int64_t>(outcome.paired.size());
  counts_.contradicted += static_cast<std::int64_t>(gone.size());
  return keep_view(robot, scan);
}

/// It is where it has seen so much of its map.
void FeatureMapper::stop(FeatureRobot& robot, std::int64_t utime, std::vector<FeatureView> views,
                         std::vector<RobotView> robots) {
  Journey& own = journey(robot);
  const Pose& pose = team_of(own).filter.state().robots[static_cast<std::size_t>(own.member)].map_from_robot;
  const std::int64_t last = own.stops.empty() ? utime : own.stops.back().utime;  // stamps may go back
  own.stops.push_back({std::max(utime, last), pose, std::exchange(robot.since_stop, {}), std::move(views),
                       std::move(robots)});
}

bool FeatureMapper::keep_view(const FeatureRobot& robot, const Scan& scan) {
  Journey& own = journeys_[static_cast<std::size_t>(robot.journey)];
  const Pose& pose = team_of(own).filter.state().robots[static_cast<std::size_t>(own.member)].map_from_robot;
  if (is_seen_from(own.views, pose * robot.declared.laser.robot_from_laser, options_.merging)) return false;
  own.views.push_back(view_of(scan, robot.declared.laser, pose, options_.merging.view_sectors));
  return true;
}

/// Where it is in its map: where its filter stands, and by odometry from there.
OdometryPath FeatureMapper::pose_of(const FeatureRobot& robot) const {
  const Journey& own = journey(robot);
  const FeatureState& state = teams_[static_cast<std::size_t>(own.team)].filter.state();
  OdometryPath pose{state.robots[static_cast<std::size_t>(own.member)].map_from_robot,
                    pose_covariance(state, own.member)};
  const Pose step = ominus(robot.odom_from_robot, robot.odom_from_last);
  if (!(step == Pose{}))
    pose.append(step, robot.tracker.noise().covariance(step, options_.engine.odometry_noise));
  return pose;
}

void FeatureMapper::add_row(const FeatureRobot& robot, std::int64_t utime) {
  Journey& own = journeys_[static_cast<std::size_t>(robot.journey)];
  own.rows.push_back({utime, pose_of(robot).start_from_end});
  moved_.insert(own.robot);
}

}  // namespace isthmus
