#include "server/feature_maps/tracking/scan_tracker.hpp"

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <utility>

#include "scanmatch/score_profile.hpp"
#include "server/engine/localise/follow.hpp"
#include "server/engine/map/slip_density.hpp"

namespace isthmus {
namespace {

LocalPatch patch_of(Observation seen, const Pose& way_from_robot) {
  auto patch = std::make_shared<Patch>();  // its free space as polygons is not needed
  static_cast<Observation&>(*patch) = std::move(seen);
  patch->id = PatchId{0};
  patch->index = PointIndex(patch->points);
  return {std::move(patch), way_from_robot};
}

bool is_near(const Pose& one, const Pose& other, const TrackingOptions& options) {
  const Pose apart = ominus(one, other);
  return std::hypot(apart.x, apart.y) < options.place_every_m &&
         std::abs(apart.yaw) < options.place_every_rad;
}

Placement place_scan(const Robot& robot, const Expectation& expectation, const LocalMap& local_map,
                     const Observation& seen, const EngineOptions& options) {
  Placement placement = localise(robot, expectation, local_map, seen.points, options);
  if (!is_doubtful(placement, options.localise)) return placement;
  std::optional<Placement> anew =
      localise_anew(robot, expectation, local_map, seen.points, seen.scan.utime, options);
  if (!anew) return placement;
  const double min_score = placement.match.quality.score + options.localise.other_start_gain;
  return placement.matched && anew->match.quality.score <= min_score ? placement : *std::move(anew);
}

/// Log-density (per m² rad) of odometry's being off by so much by its noise.
double log_noise_density(const Eigen::Vector3d& off, const Eigen::Matrix3d& covariance) {
  return -0.5 * (off.dot(covariance.inverse() * off) + std::log(covariance.determinant())) -
         1.5 * std::log(2 * std::numbers::pi);
}

/// Whether it is likelier that wheels slipped than that odometry errs so much by its noise.
bool has_slipped(const Placement& placement, const Expectation& expectation, const EngineOptions& options) {
  const Eigen::Vector3d off = wrapped_difference(expectation.local_from_robot, placement.local_from_robot);
  const double for_noise =
      log_noise_density(off, expectation.covariance) - log_slip_density(off, options.weak_links);
  return !expectation.plausible || options.localise.slip_log_odds + for_noise < 0;
}

/// Of the beams at their calibrated noise, along the direction that they know least only as far as the scan
/// does not fit as well beside (score_profile.hpp).
Eigen::Matrix3d information_of(Match match, const LocalMap& local_map, const Observation& seen,
                               const EngineOptions& options, const TrackingOptions& tracking) {
  const double sigma_m = relation_sigma_m(match.quality, options.relations);
  match.direction_trust.setIdentity();
  widen(match,
        sigma_along_weak_direction(local_map, seen.points, match, tracking.looked_along_m, options.match,
                                   options.weak_direction),
        sigma_m, options.match);
  Eigen::Matrix3d trust = Eigen::Matrix3d::Identity();
  trust.topLeftCorner<2, 2>() = match.direction_trust;
  return std::pow(options.match.sigma_m / sigma_m, 2) * trust * match.beam_information * trust.transpose();
}

/// By match and odometry together, as what is independent.
Placement with_odometry(Placement placement, const Expectation& expectation,
                        const Eigen::Matrix3d& by_match) {
  const Eigen::Matrix3d by_odometry = expectation.covariance.inverse();
  const Eigen::Vector3d off = wrapped_difference(expectation.local_from_robot, placement.local_from_robot);
  placement.covariance = (by_match + by_odometry).inverse();
  placement.local_from_robot =
      to_pose(to_vector(placement.local_from_robot) + placement.covariance * (by_odometry * off));
  return placement;
}

}  // namespace

std::optional<TrackedStep> ScanTracker::take(const Scan& scan, const Laser& laser,
                                             const Pose& odom_from_robot, const EngineOptions& options,
                                             const TrackingOptions& tracking) {
  const Observation seen = observe(scan, laser, options.patch);
  if (!place_) {
    place_.emplace();
    place_->odom_from_robot = odom_from_robot;
    place_->utime = scan.utime;
    place_->pose.patch = PatchId{0};
    keep(seen, tracking);
    return std::nullopt;
  }
  Robot robot;
  robot.noise = noise_;
  robot.place = place_;
  const Expectation expectation = expect(robot, odom_from_robot, scan.utime, options);
  Placement placement = place_scan(robot, expectation, local_map_, seen, options);
  const Placement told_by_scan = placement;
  if (placement.matched && !has_slipped(placement, expectation, options))
    placement = with_odometry(std::move(placement), expectation,
                              information_of(told_by_scan.match, local_map_, seen, options, tracking));
  const Pose before = place_->pose.patch_from_object;
  move_on(robot, expectation, told_by_scan, odom_from_robot, scan.utime, options);
  place_ = std::move(robot.place);
  place_->pose.patch_from_object = placement.local_from_robot;
  place_->tracking_covariance = placement.tracking_covariance;
  place_->covariance.setZero();  // a step is told, and errs by itself
  const bool lost = !placement.matched && place_->lost_scans >= options.common.agreeing;
  if (placement.matched || lost) keep(seen, tracking);
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(-before.yaw).toRotationMatrix();
  return TrackedStep{ominus(placement.local_from_robot, before),
                     turn * placement.covariance * turn.transpose(), placement.matched};
}

void ScanTracker::keep(const Observation& seen, const TrackingOptions& tracking) {
  const Pose& here = place_->pose.patch_from_object;
  for (const Place& place : places_)
    if (is_near(here, place.way_from_robot, tracking)) return;
  places_.push_back({seen.scan, seen.laser, here});
  local_map_.patches.push_back(patch_of(seen, here));
  if (places_.size() <= tracking.max_places) return;
  places_.pop_front();
  local_map_.patches.erase(local_map_.patches.begin());
}

void ScanTracker::restore(const EngineOptions& options) {
  local_map_.patches.clear();
  for (const Place& place : places_)
    local_map_.patches.push_back(
        patch_of(observe(place.scan, place.laser, options.patch), place.way_from_robot));
}

}  // namespace isthmus
