#include "server/wire/live/map_publisher.hpp"

#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "server/output/grid/grid.hpp"
#include "server/wire/message/encoded.hpp"

namespace isthmus {
namespace {

using Clock = std::chrono::steady_clock;

/// A grid is rendered anew when some patch of its island moved by about a pixel.
constexpr double pixel_m = 0.05;
constexpr double pixel_rad = 0.005;
/// The share of this thread's time that grids may take.
constexpr int grid_time_share = 10;

std::vector<Pose> poses_of(const MapCopy& map, const std::vector<PatchId>& patches) {
  std::vector<Pose> poses;
  poses.reserve(patches.size());
  for (const PatchId patch : patches) poses.push_back(map.poses[static_cast<std::size_t>(patch.value)]);
  return poses;
}

bool look_the_same(const std::vector<Pose>& a, const std::vector<Pose>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (std::hypot(a[i].x - b[i].x, a[i].y - b[i].y) > pixel_m) return false;
    if (std::abs(wrap_angle(a[i].yaw - b[i].yaw)) > pixel_rad) return false;
  }
  return true;
}

}  // namespace

MapPublisher::MapPublisher(Publish publish, MapPublisherOptions options)
    : publish_(std::move(publish)),
      options_(options),
      thread_([this](const std::stop_token& stop) { loop(stop); }) {}

MapPublisher::~MapPublisher() {
  thread_.request_stop();
  thread_.join();
}

void MapPublisher::offer(std::shared_ptr<const MapCopy> map, std::int64_t utime) {
  {
    const std::lock_guard lock(mutex_);
    latest_.swap(map);
    latest_utime_ = utime;
  }
  offered_.notify_one();
}

void MapPublisher::request_whole() {
  const std::lock_guard lock(mutex_);
  whole_requested_ = true;
}

void MapPublisher::loop(const std::stop_token& stop) {
  Clock::time_point next_whole = Clock::now();
  Clock::time_point next_grid = next_whole;
  Clock::time_point next_drawing = next_whole;
  while (true) {
    std::unique_lock lock(mutex_);
    if (!offered_.wait(lock, stop, [&] { return latest_ != nullptr; })) return;
    const std::shared_ptr<const MapCopy> map = std::exchange(latest_, nullptr);
    const std::int64_t utime = latest_utime_;
    const bool whole = std::exchange(whole_requested_, false) || Clock::now() >= next_whole;
    lock.unlock();

    if (whole) next_whole = Clock::now() + options_.whole_map_interval;
    publish_map(*map, utime, whole, stop);
    publish_zones(*map, utime, whole);
    withdraw_grids(*map, utime);
    const Clock::time_point start = Clock::now();
    const bool may_draw = start >= next_drawing;
    if (!whole && (!may_draw || start < next_grid)) continue;
    if (whole) publish_all_grids(*map, utime, may_draw, stop);
    if (!whole) publish_one_grid(*map, utime);
    if (!may_draw) continue;
    next_drawing = start + (Clock::now() - start) * grid_time_share;
    next_grid = std::max<Clock::time_point>(start + options_.grid_interval, next_drawing);
  }
}

void MapPublisher::publish_map(const MapCopy& map, std::int64_t utime, bool whole,
                               const std::stop_token& stop) {
  const std::vector<map_t> chunks = whole ? messages_.whole(map, utime) : messages_.changes(map, utime);
  for (const map_t& chunk : chunks) {
    if (stop.stop_requested()) return;
    publish_("ISTHMUS_MAP", encoded(chunk));
    if (chunks.size() > 1) std::this_thread::sleep_for(options_.chunk_pause);
  }
}

/// Also that there are none, with a whole map.
void MapPublisher::publish_zones(const MapCopy& map, std::int64_t utime, bool whole) {
  const std::optional<zones_t> zones = whole ? zones_.whole(map, utime) : zones_.changes(map, utime);
  if (zones) publish_("ISTHMUS_ZONES", encoded(*zones));
}

/// For those who came late.
void MapPublisher::publish_all_grids(const MapCopy& map, std::int64_t utime, bool anew,
                                     const std::stop_token& stop) {
  if (anew) {
    for (auto& [island, poses] : changed_islands(map)) {
      if (stop.stop_requested()) return;
      render(map, island, std::move(poses), utime);
    }
  }
  for (const auto& [island, grid] : rendered_) {
    if (stop.stop_requested()) return;
    publish_("ISTHMUS_GRID", grid.message);
    std::this_thread::sleep_for(options_.chunk_pause);
  }
}

/// Of islands that merged into others.
void MapPublisher::withdraw_grids(const MapCopy& map, std::int64_t utime) {
  std::set<IslandId> islands;
  for (const std::vector<PatchId>& island : map.graph.islands()) islands.insert(island.front());
  std::erase_if(rendered_, [&](const auto& grid) {
    const IslandId island = grid.first;
    if (islands.contains(island)) return false;
    publish_("ISTHMUS_GRID", encoded(grid_message({}, island, utime)));
    return true;
  });
}

/// Those that look otherwise than when they were last drawn, with the poses of their patches.
std::map<IslandId, std::vector<Pose>> MapPublisher::changed_islands(const MapCopy& map) const {
  std::map<IslandId, std::vector<Pose>> changed;
  for (const std::vector<PatchId>& island : map.graph.islands()) {
    std::vector<Pose> poses = poses_of(map, island);
    const auto rendered = rendered_.find(island.front());
    if (rendered != rendered_.end() && look_the_same(rendered->second.poses, poses)) continue;
    changed.emplace(island.front(), std::move(poses));
  }
  return changed;
}

/// The next island, in turn, that looks otherwise.
void MapPublisher::publish_one_grid(const MapCopy& map, std::int64_t utime) {
  std::map<IslandId, std::vector<Pose>> changed = changed_islands(map);
  if (changed.empty()) return;
  auto next = changed.upper_bound(last_rendered_);
  if (next == changed.end()) next = changed.begin();
  last_rendered_ = next->first;
  render(map, last_rendered_, std::move(next->second), utime);
  publish_("ISTHMUS_GRID", rendered_[last_rendered_].message);
}

void MapPublisher::render(const MapCopy& map, IslandId island, std::vector<Pose> poses, std::int64_t utime) {
  const OccupancyGrid grid = render_island(map, map.graph.patches_of(island), pixel_m, options_.grid_pixels);
  rendered_[island] = {std::move(poses), encoded(grid_message(grid, island, utime))};
}

}  // namespace isthmus
