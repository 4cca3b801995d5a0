#include "server/engine/localise/mapper.hpp"

#include <cmath>
#include <utility>

#include "server/engine/localise/extend.hpp"
#include "server/engine/localise/follow.hpp"
#include "server/engine/localise/seen_step.hpp"
#include "server/engine/localise/weighing.hpp"

namespace isthmus {
namespace {

// An unmatched scan becomes a patch only where the robot has left its surroundings behind: odometry alone
// joins it.
bool worth_a_patch_unmatched(const Robot& robot, const Placement& placement,
                             std::span<const ScanPoint> points, const EngineOptions& options) {
  const FollowOptions& its = options.follow;
  const Pose& path = robot.place->since_last_patch.start_from_end;
  return !robot.place->suspect && placement.reason != Unmatched::few_returns &&
         static_cast<double>(points.size()) >= its.unmatched_points * options.match.min_pairs &&
         robot.place->lost_scans >= options.common.agreeing &&
         (std::hypot(path.x, path.y) > its.spacing_share * options.patch_spacing_m ||
          std::abs(path.yaw) > its.spacing_share * options.patch_spacing_rad);
}

// A robot that saw too little for so long that it may be anywhere in a wide window. One scan, of a piece of a
// wall say, fits somewhere in it, whether or not the map has that wall: the robot goes on on ground of its
// own, which odometry joins, till several scans say alike where it is (LocalLoops).
bool has_lost_its_way(const Robot& robot, const EngineOptions& options) {
  const Localisation& place = *robot.place;
  const LocalLoopOptions& loops = options.local_loops;
  const double sigma_m = std::sqrt(std::max(place.covariance(0, 0), place.covariance(1, 1)));
  return place.lost_scans >= options.common.agreeing && !place.suspect &&
         loops.window_sigmas * sigma_m > loops.unambiguous_half_width_m;
}

/// A scan's place, and what it was expected by.
struct PlacedScan {
  Expectation expectation;
  Placement placement;
};

// A scan that fits nowhere lies where the scan before it has it, else where odometry has it, and what that
// told of turns errs on as before.
PlacedScan unmatched(const Robot& robot, PlacedScan placed, const Pose& odom_from_robot, std::int64_t utime,
                     const EngineOptions& options) {
  if (!placed.expectation.seen)
    placed.expectation = expect(robot, odom_from_robot, utime, options, TurnErrors::going_on);
  placed.placement.local_from_robot = placed.expectation.local_from_robot;
  placed.placement.covariance = placed.expectation.covariance;
  placed.placement.tracking_covariance = placed.expectation.tracking_covariance;
  return placed;
}

// A poor fit far from where the scan before has it is chance.
bool is_elsewhere(const Placement& placement, const Expectation& expectation,
                  const LocaliseOptions& options) {
  return placement.matched &&
         surprise(placement.local_from_robot, expectation, options) >= options.common.surprise.bound(3);
}

// Where a scan fits: in the local map or, where that is in doubt, where the scan before it has it, or clearly
// better somewhere else near.
PlacedScan place_scan(const Map& map, Robot& robot, const Pose& odom_from_robot,
                      std::span<const ScanPoint> points, std::int64_t utime, const EngineOptions& options) {
  Expectation expectation = expect(robot, odom_from_robot, utime, options);
  choose_local_map(map, robot, expectation.local_from_robot, points, options);
  Placement placement = localise(robot, expectation, robot.local_map, points, options);
  if (!is_doubtful(placement, options.localise)) return {expectation, std::move(placement)};
  if (std::optional<Expectation> seen = expect_as_seen(robot, odom_from_robot, points, utime, options)) {
    expectation = *std::move(seen);
    placement = localise(robot, expectation, robot.local_map, points, options);
    if (!is_doubtful(placement, options.localise)) return {expectation, std::move(placement)};
    if (is_elsewhere(placement, expectation, options.localise)) {
      placement.matched = false;
      placement.reason = Unmatched::low_score;
    }
  }
  LocalMap near = robot.surroundings.nearest_patches(map, expectation.local_from_robot, options.surroundings);
  std::optional<Placement> anew = localise_anew(robot, expectation, near, points, utime, options);
  if (!anew) return {expectation, std::move(placement)};
  const double min_score = placement.match.quality.score + options.localise.other_start_gain;
  if (placement.matched && anew->match.quality.score <= min_score) return {expectation, std::move(placement)};
  robot.local_map = std::move(near);
  robot.local_map_centre = anew->local_from_robot;
  return {expectation, *std::move(anew)};
}

}  // namespace

bool has_all_patches(const Robot& robot, const EngineOptions& options) {
  return robot.patches >= options.patches_per_robot;
}

bool may_not_begin(const Robot& robot, const EngineOptions& options) {
  return !robot.place && has_all_patches(robot, options);
}

ScanOutcome take_scan(Map& map, Robot& robot, Observation observation, const Pose& odom_from_robot,
                      const EngineOptions& options) {
  const std::vector<ScanPoint>& points = observation.points;
  if (!robot.place) {
    robot.last_scan = observation.scan;
    begin_island(map, robot, std::move(observation), odom_from_robot, options);
    return {answer(map, robot, true), {}, true};
  }
  const bool full = has_all_patches(robot, options);
  const std::int64_t utime = observation.scan.utime;
  PlacedScan placed = place_scan(map, robot, odom_from_robot, points, utime, options);
  auto& [expectation, placement] = placed;
  robot.last_scan = observation.scan;
  if (placement.matched && expectation.is_known() && !full && has_lost_its_way(robot, options)) {
    placement.matched = false;
    placement.reason = Unmatched::no_overlap;
  }
  if (!placement.matched) placed = unmatched(robot, std::move(placed), odom_from_robot, utime, options);
  if (!placement.matched && (robot.place->suspect || !expectation.is_known()) &&
      robot.place->lost_scans + 1 >= options.common.max_lost_scans && !full) {
    robot.health.unmatched();
    begin_island(map, robot, std::move(observation), odom_from_robot, options);
    return {answer(map, robot, true), {}, true};
  }
  follow(map, robot, expectation, placement, odom_from_robot, utime, options);
  const bool worth_it = placement.matched
                            ? worth_a_patch(map, robot.surroundings, placement, observation.star, options)
                            : worth_a_patch_unmatched(robot, placement, points, options);
  const bool loop = worth_it && !full && extend(map, robot, std::move(observation), placement, options);
  ScanOutcome outcome{answer(map, robot, placement.matched), placement.reason};
  outcome.unplaced = robot.place->suspect && !full;
  outcome.loop_closed = loop;
  outcome.patch_refused = worth_it && full;
  return outcome;
}

}  // namespace isthmus
