#include "server/wire/page/map/trails.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace isthmus {
namespace {

constexpr double step_m = 0.5;
constexpr std::size_t trail_steps = 200;
/// As long as the page shows sightings, and then some: a robot that sends slowly is known for longer.
constexpr std::size_t lately_poses = 400;
constexpr std::int64_t lately_step_us = 100'000;
constexpr std::int64_t near_us = 500'000;
/// Of the map's trajectory, the newest.
constexpr std::size_t rows_of_trails = 20'000;

}  // namespace

void Trails::add(const RobotPose& pose) {
  Robot& robot = robots_[pose.robot];
  const RobotPose& before = robot.at_step;
  const bool is_elsewhere = robot.trail.empty() || before.island != pose.island ||
                            std::hypot(pose.map_from_robot.x - before.map_from_robot.x,
                                       pose.map_from_robot.y - before.map_from_robot.y) > step_m;
  robot.newest = pose;
  robot.heard = true;
  if (robot.lately.empty() || std::abs(pose.utime - robot.lately.back().utime) >= lately_step_us)
    robot.lately.push_back(pose);
  if (robot.lately.size() > lately_poses) robot.lately.pop_front();
  if (!is_elsewhere) return;
  robot.at_step = pose;
  robot.trail.push_back(pose.pose);
  if (robot.trail.size() > trail_steps) robot.trail.pop_front();
}

void Trails::add_from_map(Trails of_map) {
  for (auto& [name, robot] : of_map.robots_) robot.heard = false;
  robots_.merge(of_map.robots_);
}

std::optional<ManifoldPose> Trails::at(const std::string& robot, std::int64_t utime) const {
  const auto found = robots_.find(robot);
  if (found == robots_.end()) return std::nullopt;
  const RobotPose* nearest = nullptr;
  for (const RobotPose& pose : found->second.lately) {
    if (!nearest || std::abs(pose.utime - utime) < std::abs(nearest->utime - utime)) nearest = &pose;
  }
  if (!nearest || std::abs(nearest->utime - utime) > near_us) return std::nullopt;
  return nearest->pose;
}

std::set<std::string> left_out_robots(const MapCopy& map) {
  std::set<std::string> robots;
  for (const PatchId id : map.left_out) robots.insert(map.patches[static_cast<std::size_t>(id.value)]->robot);
  return robots;
}

Trails trails_of(const ShownMap& shown) {
  Trails trails;
  const MapCopy& map = shown.map();
  const std::set<std::string> dropped = left_out_robots(map);
  if (!map.trajectory) return trails;
  const std::size_t rows = map.trajectory_rows;
  for (const TrajectoryRow& row :
       map.trajectory->read(rows - std::min(rows, rows_of_trails), rows_of_trails)) {
    const ManifoldPose at{row.patch, row.patch_from_robot};
    if (!shown.has(row.patch)) continue;
    RobotPose pose;
    pose.robot = map.sessions.at(static_cast<std::size_t>(row.session)).robot;
    if (dropped.contains(pose.robot)) continue;
    pose.utime = row.utime;
    pose.island = shown.island(row.patch);
    pose.pose = at;
    pose.map_from_robot = shown.project(at);
    pose.matched = true;
    trails.add(pose);
  }
  return trails;
}

}  // namespace isthmus
