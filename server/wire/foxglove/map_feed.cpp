#include "server/wire/foxglove/map_feed.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace isthmus::foxglove {
namespace {

constexpr const char* frames_topic = "/tf";
constexpr const char* scene_topic = "/scene";
constexpr const char* log_topic = "/log";

std::string grid_topic(const std::string& frame) { return "/" + frame + "/grid"; }
std::string pose_topic(const std::string& robot) { return "/" + robot + "/pose"; }
std::string scan_topic(const std::string& robot) { return "/" + robot + "/scan"; }

/// A grid is drawn anew when some patch of its island moved by about a cell.
constexpr double grid_still_m = 0.05;
constexpr double grid_still_rad = 0.005;

bool look_the_same(const std::vector<Pose>& a, const std::vector<Pose>& b) {
  return std::ranges::equal(a, b, [](const Pose& one, const Pose& other) {
    return std::hypot(one.x - other.x, one.y - other.y) <= grid_still_m &&
           std::abs(wrap_angle(one.yaw - other.yaw)) <= grid_still_rad;
  });
}

std::vector<Pose> poses_of(const MapCopy& map, const Island& island) {
  std::vector<Pose> poses;
  for (const PatchId id : island.patches) poses.push_back(map.poses[static_cast<std::size_t>(id.value)]);
  return poses;
}

std::vector<Transform> frames_of(const RobotPose& pose, const std::optional<Laser>& laser) {
  std::vector<Transform> frames = {{island_frame(pose.island.value), pose.robot, pose.map_from_robot}};
  if (laser) frames.push_back({pose.robot, pose.robot + "/laser", laser->robot_from_laser});
  return frames;
}

}  // namespace

MapFeed::MapFeed(Broadcast& broadcast, Options options) : broadcast_(broadcast), options_(options) {
  broadcast_.open(frames_topic, Kind::frame_transforms, Broadcast::Keep::all);
  broadcast_.open(scene_topic, Kind::scene_update, Broadcast::Keep::newest);
  broadcast_.open(log_topic, Kind::log, Broadcast::Keep::all);
}

MapFeed::Robot& MapFeed::robot(const std::string& name) {
  const auto [known, is_new] = robots_.try_emplace(name);
  if (is_new) {
    broadcast_.open(pose_topic(name), Kind::pose_in_frame, Broadcast::Keep::newest);
    broadcast_.open(scan_topic(name), Kind::laser_scan, Broadcast::Keep::all);
  }
  return known->second;
}

void MapFeed::show(const RobotPose& pose) {
  Robot& of = robot(pose.robot);
  of.newest = pose;
  if (broadcast_.is_heard(frames_topic))
    broadcast_.send(frames_topic, pose.utime, frame_transforms(pose.utime, frames_of(pose, of.laser)));
  broadcast_.send(pose_topic(pose.robot), pose.utime,
                  pose_in_frame(pose.utime, island_frame(pose.island.value), pose.map_from_robot));
}

bool MapFeed::wants_scans() const {
  return std::ranges::any_of(robots_,
                             [&](const auto& robot) { return broadcast_.is_heard(scan_topic(robot.first)); });
}

void MapFeed::show(const RobotEvent& event) { robot(event.robot).laser = event.laser; }

void MapFeed::show(const ScanEvent& event) {
  const Robot& of = robot(event.robot);
  const std::string topic = scan_topic(event.robot);
  if (!of.laser || !broadcast_.is_heard(topic)) return;
  broadcast_.send(topic, event.scan.utime, laser_scan(event.scan, *of.laser, event.robot + "/laser"));
}

void MapFeed::show(const MapCopy& map, const status_t& status, Clock::time_point now) {
  const std::vector<Island> islands = islands_of(map);
  if (broadcast_.is_heard(frames_topic)) show_frames(map, islands, status.utime);
  show_grids(map, islands, status.utime, now);
  show_scene(map, islands, status.utime, now);
  tell_closures(map, status.utime);
  tell_warnings(status);
}

/// Those with most patches first.
std::vector<Island> MapFeed::islands_of(const MapCopy& map) const {
  const RankedIslands ranked = rank_islands(map);
  std::vector<Island> islands;
  for (std::size_t k = 0; k < ranked.patches.size(); ++k) {
    PatchId lowest = ranked.patches[k].front();
    if (!ranked.tags[k].empty()) lowest = std::min(lowest, ranked.tags[k].front());
    islands.push_back({island_frame(lowest.value), ranked.patches[k]});
  }
  return islands;
}

/// All of them, for those who come late and for robots that stand still.
void MapFeed::show_frames(const MapCopy& map, const std::vector<Island>& islands, std::int64_t utime) {
  std::vector<Island> by_id = islands;
  std::ranges::sort(by_id, {}, [](const Island& island) { return island.patches.front(); });
  std::string message = frame_transforms(utime, side_by_side(map, by_id));
  broadcast_.send(frames_topic, utime, std::move(message));
  for (const auto& [name, of] : robots_)
    if (of.newest)
      broadcast_.send(frames_topic, of.newest->utime,
                      frame_transforms(of.newest->utime, frames_of(*of.newest, of.laser)));
}

void MapFeed::show_grids(const MapCopy& map, const std::vector<Island>& islands, std::int64_t utime,
                         Clock::time_point now) {
  std::set<std::string> current;
  for (const Island& island : islands) {
    if (current.size() >= options_.grids) break;
    current.insert(island.frame);
    const std::string topic = grid_topic(island.frame);
    Drawn& drawn = grids_[island.frame];
    broadcast_.open(topic, Kind::grid, Broadcast::Keep::newest);
    if (!broadcast_.is_heard(topic) || (!drawn.poses.empty() && now - drawn.when < options_.grid_interval))
      continue;
    std::vector<Pose> poses = poses_of(map, island);
    if (look_the_same(poses, drawn.poses)) continue;
    drawn = {now, std::move(poses)};
    const OccupancyGrid cells = render_island(map, island.patches, options_.grid_cell_m, max_grid_cells);
    broadcast_.send(topic, utime, grid(utime, cells, island.frame));
  }
  std::erase_if(grids_, [&](const auto& one) {
    if (current.contains(one.first)) return false;
    broadcast_.close(grid_topic(one.first));
    return true;
  });
}

void MapFeed::show_scene(const MapCopy& map, const std::vector<Island>& islands, std::int64_t utime,
                         Clock::time_point now) {
  const bool is_first = scene_sent_ == Clock::time_point();
  if (!broadcast_.is_heard(scene_topic) || (!is_first && now - scene_sent_ < options_.scene_interval)) return;
  std::vector<Scene> all = scenes(map, islands);
  if (all == scene_) return;
  std::set<std::string> frames;
  for (const Island& island : islands) frames.insert(island.frame);
  std::vector<std::string> gone;
  std::ranges::set_difference(scene_frames_, frames, std::back_inserter(gone));
  broadcast_.send(scene_topic, utime, scene_update(utime, all, gone));
  scene_frames_ = std::move(frames);
  scene_ = std::move(all);
  scene_sent_ = now;
}

void MapFeed::tell_closures(const MapCopy& map, std::int64_t utime) {
  for (const ClosureRecord& closure : map.closures) {
    ClosureState& state = closures_[closure.id];
    if (std::exchange(state, closure.state) == closure.state || !broadcast_.is_heard(log_topic)) continue;
    broadcast_.send(log_topic, utime, log(utime, closure_level(closure), closure_text(closure)));
  }
}

/// Those that begin.
void MapFeed::tell_warnings(const status_t& status) {
  std::set<std::string> now;
  for (const warning_t& warning : status.warnings) {
    now.insert(warning.kind + ' ' + warning.robot);
    if (warnings_.contains(warning.kind + ' ' + warning.robot) || !broadcast_.is_heard(log_topic)) continue;
    broadcast_.send(log_topic, status.utime,
                    log(status.utime, Level::warning, warning.kind + ": " + warning.text));
  }
  warnings_ = std::move(now);
}

}  // namespace isthmus::foxglove
