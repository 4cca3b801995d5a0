#include "server/engine/frozen/sighted_pose.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace isthmus {
namespace {

using std::numbers::pi;

constexpr int arcs = 16;  // of the circle about what a robot sees

bool has_range_and_bearing(const SightingEvent& event) {
  return std::isfinite(event.range_sigma_m) && std::isfinite(event.bearing_sigma_rad);
}

// About a point of an island's plane, as if somebody said so; nothing off the map.
std::optional<ManifoldPose> about(const Map& map, PatchId on_island_of, const Pose& at) {
  InitialPoseEvent event;
  event.island = map.graph().island(on_island_of);
  event.pose = at;
  return read_given_pose(event, map).pose;
}

}  // namespace

bool is_found(const Robot& robot) { return robot.place && !robot.place->suspect; }

std::optional<ManifoldPose> place_at(const Robot& robot, std::int64_t utime) {
  const std::optional<Pose> odom_from_robot = robot.odometry.at(utime);
  if (!odom_from_robot) return std::nullopt;
  const Pose moved = ominus(*odom_from_robot, robot.place->odom_from_robot);
  return ManifoldPose{robot.place->pose.patch, robot.place->pose.patch_from_object * moved};
}

std::optional<ManifoldPose> place_of_tag(const Map& map, std::int32_t barcode) {
  for (const PatchPtr& patch : map.manifold().patches())
    if (patch->tag == barcode) return ManifoldPose{patch->id, {}};
  return std::nullopt;
}

std::optional<GivenPose> where_it_sees(const SightingEvent& event, const std::optional<ManifoldPose>& target,
                                       const Map& map, const FrozenOptions& options) {
  if (!target || !has_range_and_bearing(event)) return std::nullopt;
  const Pose there = map.manifold().project(*target);
  const std::optional<ManifoldPose> near = about(map, target->patch, {there.x, there.y, 0});
  if (!near) return std::nullopt;
  GivenPose given;
  given.pose = *near;
  for (int i = 0; i < arcs; ++i) {
    const double from_there = 2 * pi * i / arcs;
    const Pose robot{event.range_m * std::cos(from_there), event.range_m * std::sin(from_there),
                     wrap_angle(from_there + pi - event.bearing_rad)};
    given.or_at.push_back(near->patch_from_object * robot);
  }
  given.pose.patch_from_object = given.or_at.back();
  given.or_at.pop_back();
  const double half_arc = pi / arcs;
  given.sigma_m = event.range_m * half_arc / options.given_sigmas + event.range_sigma_m;
  given.sigma_rad = half_arc / options.given_sigmas + event.bearing_sigma_rad;
  return given;
}

std::optional<GivenPose> where_it_is_seen(const SightingEvent& event,
                                          const std::optional<ManifoldPose>& observer, const Map& map,
                                          const FrozenOptions& options) {
  if (!observer || !has_range_and_bearing(event)) return std::nullopt;
  const Pose seen = map.manifold().project(*observer) * Pose{event.range_m * std::cos(event.bearing_rad),
                                                             event.range_m * std::sin(event.bearing_rad), 0};
  const std::optional<ManifoldPose> near = about(map, observer->patch, seen);
  if (!near) return std::nullopt;
  GivenPose given;
  given.pose = *near;
  given.sigma_m = std::hypot(event.range_sigma_m, event.range_m * event.bearing_sigma_rad);
  given.sigma_rad = pi / options.given_sigmas;
  return given;
}

}  // namespace isthmus
