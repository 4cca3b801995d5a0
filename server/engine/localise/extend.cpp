#include "server/engine/localise/extend.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "relations/odometry_relation.hpp"
#include "scanmatch/match_relations.hpp"
#include "server/engine/map/local_loop.hpp"

namespace isthmus {
namespace {

// In the direction in which a scan tells least, a robot on known ground is where it was tracked to: from the
// patch that it stood on, as surely as that is known beyond what odometry since its last patch says. Nothing
// where the scan tells of all directions, or the robot stands on that last patch.
std::optional<Relation> ground_relation(const Map& map, const Robot& robot, const Placement& placement,
                                        const Relation& odometry, const EngineOptions& options) {
  const PatchId ground = robot.surroundings.reference();
  if (ground == odometry.a ||
      placement.match.direction_trust.determinant() > options.odometry_learning.well_known)
    return std::nullopt;
  const Eigen::JacobiSVD<Eigen::Matrix2d> trust(placement.match.direction_trust, Eigen::ComputeFullV);
  const Eigen::Vector2d along = trust.matrixV().col(1);
  const double left_to_odometry = 1 - trust.singularValues()(1);
  const Eigen::Matrix2d known = placement.covariance.inverse().topLeftCorner<2, 2>();
  const Eigen::Vector2d in_previous = rotate(-map.relative_pose(ground, odometry.a).yaw, along);
  const Eigen::Matrix2d by_odometry =
      std::get<RelativePose>(odometry.measurement).information.inverse().topLeftCorner<2, 2>();
  const double information = left_to_odometry * left_to_odometry * along.dot(known * along) -
                             1 / in_previous.dot(by_odometry * in_previous);
  if (!(information > 0)) return std::nullopt;
  Relation relation;
  relation.a = ground;
  relation.b = odometry.b;
  relation.kind = RelationKind::relative_pose;
  RelativePose measured{placement.local_from_robot, Eigen::Matrix3d::Zero()};
  measured.information.topLeftCorner<2, 2>() = information * along * along.transpose();
  relation.measurement = measured;
  relation.origin = {OriginKind::match, {}};
  return relation;
}

// Patches that a scan should overlap and was not found to.
std::vector<PatchId> unpaired_patches(const LocalMap& local_map, std::span<const Relation> relations) {
  std::vector<PatchId> unpaired;
  for (const LocalPatch& local : local_map.patches) {
    const PatchId id = local.patch->id;
    const bool paired =
        std::any_of(relations.begin(), relations.end(), [&](const Relation& r) { return r.a == id; });
    if (!paired) unpaired.push_back(id);
  }
  return unpaired;
}

// Whether a patch of like heading lies where a robot is, though the surroundings lack it: they hold the
// patches nearest in the graph, the oldest of those equally near, and a team that drives about for hours
// makes the graph so dense that the newest would never be seen, and made again and again.
bool has_looked_from_here(const Map& map, PatchId reference, const Pose& local_from_robot,
                          const EngineOptions& options) {
  const std::vector<PatchId> near =
      map.graph().within_hops(reference, options.extend.same_place_hops, says_where_walls_are);
  return std::ranges::any_of(near, [&](PatchId id) {
    const Pose patch_from_robot =
        map.manifold().transform({reference, local_from_robot}, id).patch_from_object;  // eq. 3
    return std::hypot(patch_from_robot.x, patch_from_robot.y) < options.patch_spacing_m &&
           std::abs(patch_from_robot.yaw) < options.patch_spacing_rad;
  });
}

// The way since the last patch, with the turn that odometry by itself tells of it: where a scan was matched,
// its relations say what scans do.
OdometryPath told_path(const Localisation& place) {
  OdometryPath path = place.since_last_patch;
  path.face(place.told_since_last_patch.rad, place.told_since_last_patch.variance_rad2);
  return path;
}

// Of its errors at random, and of those that it has in common with the paths before and after it.
Eigen::Matrix3d path_covariance(Robot& robot, const OdometryPath& path, const Pose& matched, bool well_seen,
                                const EngineOptions& options) {
  Eigen::Matrix3d covariance = robot.noise.path_covariance(path.start_from_end, path.covariance, matched,
                                                           well_seen, options.odometry_noise);
  covariance(2, 2) += robot.bias.path_yaw_variance(path.start_from_end, options.odometry_bias);
  return covariance;
}

}  // namespace

Relation odometry_relation(Robot& robot, PatchId next, const EngineOptions& options) {
  const OdometryPath& path = robot.place->since_last_patch;
  // Where nothing matches, its own account is all there is.
  return odometry_relation(robot.place->last_patch, next, path.start_from_end,
                           path_covariance(robot, path, path.start_from_end, false, options));
}

void put_robot_on(Robot& robot, PatchId patch) {
  Localisation& place = *robot.place;
  place.pose = {patch, Pose{}};
  place.covariance = place.tracking_covariance = Eigen::Matrix3d::Identity() * 1e-8;
  place.last_patch = patch;
  place.since_last_patch = {};
  place.told_since_last_patch = {};
  ++robot.patches;
}

double uncovered_share(const Star& star, std::span<const LocalPatch> patches_near,
                       const Pose& local_from_robot, const ExtendOptions& options) {
  std::vector<Pose> patch_from_robot;
  for (const LocalPatch& near : patches_near) {
    patch_from_robot.push_back(ominus(local_from_robot, near.local_from_patch));
  }
  const std::vector<float>& ranges = star.ranges_m();
  const std::size_t stride = std::max<std::size_t>(1, ranges.size() / options.sampled_beams);
  double area = 0;
  double uncovered = 0;
  for (std::size_t beam = stride / 2; beam < ranges.size(); beam += stride) {
    const double range = std::min<double>(ranges[beam], options.max_sample_m);
    const double bearing = star.bearing0_rad() + static_cast<double>(beam) * star.bearing_step_rad();
    for (int i = 0; i < options.samples_of_beam; ++i) {
      const double share = std::sqrt((i + 0.5) / options.samples_of_beam);  // so that all stand for one area
      const Eigen::Vector2d at = star.robot_from_laser() * Eigen::Vector2d(share * range * std::cos(bearing),
                                                                           share * range * std::sin(bearing));
      const double weight = range * range;
      area += weight;
      bool covered = false;
      for (std::size_t k = 0; k < patches_near.size() && !covered; ++k) {
        covered = patches_near[k].patch->star.contains(patch_from_robot[k] * at);
      }
      if (!covered) uncovered += weight;
    }
  }
  return area > 0 ? uncovered / area : 0;
}

bool worth_a_patch(const Map& map, const Surroundings& surroundings, const Placement& placement,
                   const Star& star, const EngineOptions& options) {
  struct Near {
    const Determined* determined;
    double distance_m;
  };
  std::vector<Near> near;
  bool near_by = false;
  bool close = false;
  bool here = false;
  const ExtendOptions& its = options.extend;
  const Pose& local_from_robot = placement.local_from_robot;
  for (const Determined& determined : surroundings.patches()) {
    if (!determined.well_determined) continue;
    const Pose& local_from_patch = determined.local_from_patch;
    const double distance =
        std::hypot(local_from_robot.x - local_from_patch.x, local_from_robot.y - local_from_patch.y);
    if (distance > its.near_reaches * options.surroundings.reach_m) continue;
    near.push_back({&determined, distance});
    const double turned = std::abs(wrap_angle(local_from_robot.yaw - local_from_patch.yaw));
    here = here || (distance < its.here_share * options.patch_spacing_m &&
                    turned < its.here_share * options.patch_spacing_rad);
    near_by = near_by || distance < options.patch_spacing_m;
    close = close || (distance < options.patch_spacing_m && turned < options.patch_spacing_rad);
  }
  const double score = placement.match.quality.score;
  if (!near_by || (!here && score < its.thin_score)) return true;
  std::sort(near.begin(), near.end(),
            [](const Near& a, const Near& b) { return a.distance_m < b.distance_m; });
  std::vector<LocalPatch> patches;
  patches.reserve(near.size());
  for (const Near& n : near)
    patches.push_back({map.manifold().shared_patch(n.determined->patch), n.determined->local_from_patch});
  const double uncovered = uncovered_share(star, patches, local_from_robot, its);
  // Seen from here before, but turned away: worth a patch only if those who looked elsewhere saw less of it.
  if (!close && (score < its.turned_score || uncovered > its.turned_uncovered_share) &&
      !has_looked_from_here(map, surroundings.reference(), local_from_robot, options))
    return true;
  return uncovered > options.uncovered_share;
}

void begin_island(Map& map, Robot& robot, Observation observation, const Pose& odom_from_robot,
                  const EngineOptions& options) {
  const PatchId id = map.manifold().next_id();
  const std::int64_t utime = observation.scan.utime;
  map.add(make_patch(id, robot.declaration.robot, std::move(observation), options.patch), Pose{});
  robot.place = Localisation{};
  robot.local_loops.clear();
  robot.place->odom_from_robot = odom_from_robot;
  robot.place->utime = utime;
  put_robot_on(robot, id);
}

bool extend(Map& map, Robot& robot, Observation observation, const Placement& placement,
            const EngineOptions& options) {
  const std::vector<ScanPoint>& points = observation.points;
  const PatchId id = map.manifold().next_id();
  const Pose& local_from_robot = placement.local_from_robot;
  std::vector<Relation> relations;
  if (placement.matched) {
    relations = match_relations(robot.local_map, points, placement.match, id, {OriginKind::match, {}},
                                options.relations);
  }
  std::vector<Relation> loop;
  if (placement.matched) {
    const std::vector<PatchId> unpaired = unpaired_patches(robot.local_map, relations);
    loop = robot.local_loops.take(
        find_local_loop(map, robot.surroundings, local_from_robot, points, unpaired, id, options),
        options.local_loops);
  }
  const Pose map_from_robot = map.manifold().pose(robot.surroundings.reference()) * local_from_robot;
  map.add(make_patch(id, robot.declaration.robot, std::move(observation), options.patch), map_from_robot);
  const OdometryPath path = placement.matched ? told_path(*robot.place) : robot.place->since_last_patch;
  const PatchId previous = robot.place->last_patch;
  const bool well_seen = placement.matched &&
                         placement.match.direction_trust.determinant() > options.odometry_learning.well_known;
  const Pose previous_from_robot =
      placement.matched ? ominus(map_from_robot, map.manifold().pose(previous)) : path.start_from_end;
  const Eigen::Matrix3d covariance = path_covariance(robot, path, previous_from_robot, well_seen, options);
  const Relation odometry = odometry_relation(previous, id, path.start_from_end, covariance);
  if (placement.matched) {
    if (std::optional<Relation> ground = ground_relation(map, robot, placement, odometry, options))
      relations.push_back(*std::move(ground));
  }
  map.relate(odometry);
  for (const Relation& relation : relations) map.relate(relation);
  for (const Relation& relation : loop) map.relate(relation);
  put_robot_on(robot, id);
  map.refit_around(id,
                   loop.empty() ? options.map_fit.window_patches : options.surroundings.confidence_patches);
  return !loop.empty();
}

}  // namespace isthmus
