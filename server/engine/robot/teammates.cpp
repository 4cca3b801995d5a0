#include "server/engine/robot/teammates.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace isthmus {
namespace {

double age_s(std::int64_t a, std::int64_t b) { return std::abs(static_cast<double>(a - b)) * 1e-6; }

double sigma_m(const Eigen::Matrix3d& covariance) {
  return std::sqrt(std::max(0.0, 0.5 * covariance.topLeftCorner<2, 2>().trace()));
}

double footprint_m(const std::map<std::string, Robot>& robots, const std::string& name) {
  const auto found = robots.find(name);
  return found == robots.end() ? 0 : found->second.declaration.footprint_radius_m;
}

}  // namespace

void note_teammate(Robot& robot, const SightingEvent& sighting, const std::string& target,
                   const Pose& odom_from_robot) {
  if (!std::isfinite(sighting.range_sigma_m) || !std::isfinite(sighting.bearing_sigma_rad)) return;
  const Eigen::Vector2d seen(sighting.range_m * std::cos(sighting.bearing_rad),
                             sighting.range_m * std::sin(sighting.bearing_rad));
  const double sigma = std::max(sighting.range_sigma_m, sighting.range_m * sighting.bearing_sigma_rad);
  robot.seen[target] = {sighting.utime, odom_from_robot * seen, sigma};
}

std::vector<Body> teammates_around(const Map& map, const std::map<std::string, Robot>& robots,
                                   const Robot& robot, const Pose& odom_from_robot, std::int64_t utime,
                                   const TeammateOptions& options) {
  const auto slack_m = [&](double sigma_m, double age_s) {
    return std::min(options.max_slack_m, options.slack_sigmas * sigma_m + options.speed_m_per_s * age_s);
  };
  std::vector<Body> bodies;
  const Pose robot_from_odom = inverse(odom_from_robot);
  for (const auto& [name, seen] : robot.seen) {
    if (std::abs(seen.utime - utime) > options.seen_us) continue;
    const double slack = slack_m(seen.sigma_m, age_s(seen.utime, utime));
    bodies.push_back(
        {robot_from_odom * seen.odom_position, footprint_m(robots, name) + options.margin_m + slack});
  }
  if (!robot.place) return bodies;
  const IslandId island = map.graph().island(robot.place->pose.patch);
  const Pose map_from_robot =
      map.manifold().project(robot.place->pose) * ominus(odom_from_robot, robot.place->odom_from_robot);
  for (const auto& [name, other] : robots) {
    if (&other == &robot || !other.place || std::abs(other.place->utime - utime) > options.placed_us)
      continue;
    if (map.graph().island(other.place->pose.patch) != island) continue;
    const Pose its = map.manifold().project(other.place->pose);
    const double age = std::min(options.max_age_s, age_s(other.place->utime, utime));
    const double sigma = std::hypot(sigma_m(other.place->covariance), sigma_m(robot.place->covariance));
    bodies.push_back({inverse(map_from_robot) * position(its),
                      other.declaration.footprint_radius_m + options.margin_m + slack_m(sigma, age)});
  }
  return bodies;
}

Scan without_bodies(const Scan& scan, const Laser& laser, const std::vector<Body>& bodies) {
  Scan clean = scan;
  if (bodies.empty()) return clean;
  for (std::size_t i = 0; i < clean.ranges_m.size(); ++i) {
    const float range = clean.ranges_m[i];
    if (classify(range, laser) != BeamKind::hit) continue;
    const double bearing = scan.bearing0_rad + static_cast<double>(i) * scan.bearing_step_rad;
    const Eigen::Vector2d end =
        laser.robot_from_laser * Eigen::Vector2d(range * std::cos(bearing), range * std::sin(bearing));
    const bool on_body = std::ranges::any_of(
        bodies, [&](const Body& body) { return (end - body.position).norm() < body.radius_m; });
    if (on_body) clean.ranges_m[i] = std::numeric_limits<float>::quiet_NaN();
  }
  return clean;
}

}  // namespace isthmus
