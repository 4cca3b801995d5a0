#include "server/engine/localise/footprints.hpp"

#include <cmath>
#include <numbers>

#include "server/engine/localise/extend.hpp"

namespace isthmus {
namespace {

// A disc drawn out from one point to another: a half disc at either end.
Ring capsule(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double radius_m, int corners) {
  const Eigen::Vector2d way = to - from;
  const double heading = way.norm() > 1e-6 ? std::atan2(way.y(), way.x()) : 0;
  Ring ring;
  for (int i = 0; i <= corners / 2; ++i) {
    const double angle = heading - std::numbers::pi / 2 + 2 * std::numbers::pi * i / corners;
    ring.emplace_back(to + radius_m * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  for (int i = 0; i <= corners / 2; ++i) {
    const double angle = heading + std::numbers::pi / 2 + 2 * std::numbers::pi * i / corners;
    ring.emplace_back(from + radius_m * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return ring;
}

ScanOutcome answered(const Map& map, const Robot& robot, bool new_session) {
  ScanOutcome outcome;
  const Localisation& place = *robot.place;
  outcome.new_session = new_session;
  outcome.pose.robot = robot.declaration.robot;
  outcome.pose.utime = place.utime;
  outcome.pose.island = map.graph().island(place.pose.patch);
  outcome.pose.pose = place.pose;
  outcome.pose.covariance = place.covariance;
  outcome.pose.map_from_robot = map.manifold().project(place.pose);
  outcome.pose.map_from_odom = outcome.pose.map_from_robot * inverse(place.odom_from_robot);
  return outcome;
}

void stand_on_new_patch(Map& map, Robot& robot, const Pose& map_from_robot, const EngineOptions& options) {
  Localisation& place = *robot.place;
  const PatchId id = map.manifold().next_id();
  const std::vector<Pose> way = robot.way.empty() ? std::vector<Pose>{place.odom_from_robot} : robot.way;
  std::vector<Pose> patch_from_robot;
  for (const Pose& odom_from_then : way)
    patch_from_robot.push_back(ominus(odom_from_then, place.odom_from_robot));
  patch_from_robot.push_back(Pose{});
  map.add(make_swept_patch(id, robot.declaration.robot, place.utime, robot.declaration.footprint_radius_m,
                           patch_from_robot, options.footprints),
          map_from_robot);
  if (place.last_patch.valid()) map.relate(odometry_relation(robot, id, options));
  robot.way = {place.odom_from_robot};
  put_robot_on(robot, id);
}

// The first odometry since the robot says that it has no laser any more: it stands on a patch of its own,
// tied to the one on which its scans have put it, as surely as they have.
void leave_laser(Map& map, Robot& robot, bool full, const EngineOptions& options) {
  Localisation& place = *robot.place;
  place.last_patch = place.pose.patch;
  place.since_last_patch = {place.pose.patch_from_object, place.covariance};
  robot.way = {place.odom_from_robot};
  if (!full) stand_on_new_patch(map, robot, map.manifold().project(place.pose), options);
}

}  // namespace

bool has_no_laser(const Robot& robot) { return robot.declaration.laser.range_max_m <= 0; }

PatchPtr make_swept_patch(PatchId id, const std::string& robot, std::int64_t utime, double radius_m,
                          const std::vector<Pose>& patch_from_robot, const FootprintOptions& options) {
  auto patch = std::make_shared<Patch>();
  patch->id = id;
  patch->robot = robot;
  patch->utime = utime;
  std::vector<PolygonWithHoles> swept;
  for (std::size_t i = 0; i < patch_from_robot.size(); ++i) {
    const Pose& from = patch_from_robot[i > 0 ? i - 1 : 0];
    swept.push_back({capsule(position(from), position(patch_from_robot[i]),
                             std::max(radius_m, options.min_radius_m), options.corners),
                     {}});
  }
  patch->free_space = Polysolid(std::move(swept));
  return patch;
}

std::optional<ScanOutcome> take_odometry(Map& map, Robot& robot, const Pose& odom_from_robot,
                                         std::int64_t utime, const EngineOptions& options) {
  if (robot.place && utime < robot.place->utime + options.footprints.period_us) return std::nullopt;
  const bool first = !robot.place;
  const bool full = has_all_patches(robot, options);
  const bool jumped = !first && !full && !expect(robot, odom_from_robot, utime, options).plausible;
  const bool had_laser = !first && robot.way.empty();
  const bool lost = had_laser && !full && robot.place->suspect;
  if (first || jumped || lost) {
    robot.place = Localisation{};
    robot.place->odom_from_robot = odom_from_robot;
    robot.place->utime = utime;
    robot.local_loops.clear();
    robot.way.clear();
    stand_on_new_patch(map, robot, Pose{}, options);
    return answered(map, robot, true);
  }
  if (had_laser) leave_laser(map, robot, full, options);
  const Expectation expectation = expect(robot, odom_from_robot, utime, options);
  Localisation& place = *robot.place;
  place.pose.patch_from_object = expectation.local_from_robot;
  place.covariance = expectation.covariance;
  place.tracking_covariance = expectation.tracking_covariance;
  place.last_step = expectation.step;
  place.append(expectation.step, expectation.step_covariance);
  place.odom_from_robot = odom_from_robot;
  place.utime = utime;
  const Pose since = ominus(odom_from_robot, robot.way.back());
  if (full) robot.way.clear();
  if (full || std::hypot(since.x, since.y) > options.footprints.way_step_m)
    robot.way.push_back(odom_from_robot);
  const Pose& r = place.pose.patch_from_object;
  const bool worth_it =
      std::hypot(r.x, r.y) > options.patch_spacing_m || std::abs(r.yaw) > options.patch_spacing_rad;
  if (worth_it && !full) stand_on_new_patch(map, robot, map.manifold().project(place.pose), options);
  ScanOutcome outcome = answered(map, robot, false);
  outcome.patch_refused = worth_it && full;
  return outcome;
}

}  // namespace isthmus
