#include "tools/export/mcap/map_mcap.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>

#include "server/output/foxglove/map_content.hpp"
#include "server/output/tables/islands.hpp"
#include "server/output/tables/trajectories.hpp"
#include "server/wire/journal/event_log.hpp"
#include "server/wire/message/server_configuration.hpp"
#include "tools/export/mcap/mcap_writer.hpp"

namespace isthmus {
namespace {

using foxglove::Kind;

constexpr std::size_t rows_at_a_time = 4096;
constexpr std::uint64_t ns_per_us = 1000;

std::uint64_t nanoseconds(std::int64_t utime) {
  return ns_per_us * static_cast<std::uint64_t>(std::max<std::int64_t>(utime, 0));
}

/// The rows of a trajectory, one after the other.
class Rows {
 public:
  explicit Rows(const MapCopy& map) : map_(map) {}

  const TrajectoryRow* peek() {
    if (at_ < rows_.size()) return &rows_[at_];
    if (!map_.trajectory || read_ >= map_.trajectory_rows) return nullptr;
    rows_ = map_.trajectory->read(read_, std::min(rows_at_a_time, map_.trajectory_rows - read_));
    read_ += rows_.size();
    at_ = 0;
    return rows_.empty() ? nullptr : &rows_.front();
  }
  void pop() { ++at_; }

 private:
  const MapCopy& map_;
  std::vector<TrajectoryRow> rows_;
  std::size_t at_ = 0;
  std::size_t read_ = 0;
};

class MapMcap {
 public:
  MapMcap(const MapCopy& map, const Configuration& configuration, const std::string& path,
          const McapOptions& options)
      : map_(map),
        islands_(rank_islands(map)),
        options_(options),
        channel_names_(channels_of(configuration)),
        rows_(map),
        writer_(path) {
    for (const std::string& robot : robots_of(map)) add_robot(robot);
    transforms_ = add("/tf", Kind::frame_transforms);
    scene_ = add("/scene", Kind::scene_update);
    log_ = add("/log", Kind::log);
  }

  std::uint64_t write() {
    write_islands();
    sort_closures();
    if (!options_.log.empty()) write_log();
    constexpr std::int64_t end = std::numeric_limits<std::int64_t>::max();
    write_poses(end);
    write_closures(end);
    writer_.finish();
    return writer_.messages();
  }

 private:
  struct Robot {
    std::uint16_t pose = 0;
    std::optional<std::uint16_t> scan;
    std::optional<Laser> laser;
  };

  std::uint16_t add(const std::string& topic, Kind kind) {
    const foxglove::Schema schema = foxglove::schema(kind);
    return writer_.add_channel(topic, schema.name, schema.text);
  }

  void add_robot(const std::string& robot) {
    robots_[robot].pose = add("/" + robot + "/pose", Kind::pose_in_frame);
    if (!options_.log.empty()) robots_[robot].scan = add("/" + robot + "/scan", Kind::laser_scan);
  }

  std::int64_t first_utime() const {
    std::int64_t first = std::numeric_limits<std::int64_t>::max();
    for (const Session& session : map_.sessions) first = std::min(first, session.from_utime);
    return map_.sessions.empty() ? 0 : first;
  }

  /// Frames, grids and scene: all that does not change.
  void write_islands() {
    const std::int64_t utime = first_utime();
    note_stamp(utime);
    std::vector<foxglove::Island> islands;
    for (const std::vector<PatchId>& patches : islands_.patches)
      islands.push_back({foxglove::island_frame(static_cast<int>(islands.size())), patches});
    for (const foxglove::Island& island : islands) {
      const OccupancyGrid grid =
          render_island(map_, island.patches, options_.resolution_m, foxglove::max_grid_cells);
      writer_.write(add("/" + island.frame + "/grid", Kind::grid), nanoseconds(utime),
                    foxglove::grid(utime, grid, island.frame));
    }
    writer_.write(transforms_, nanoseconds(utime),
                  foxglove::frame_transforms(utime, foxglove::side_by_side(map_, islands)));
    writer_.write(scene_, nanoseconds(utime), foxglove::scene_update(utime, foxglove::scenes(map_, islands)));
  }

  void sort_closures() {
    for (const ClosureRecord& closure : map_.closures) closures_.push_back(&closure);
    std::ranges::stable_sort(closures_, {}, [](const ClosureRecord* one) { return one->end_utime; });
  }

  /// Poses, closures and scans as time goes by. Closures are told by the time at which messages came, all
  /// else by the robots' clocks: of the two, these are what the file has.
  void write_log() {
    EventLogReader reader(options_.log);
    while (const std::optional<Message> message = reader.next()) {
      const Decoded decoded = decode(channel_names_, message->channel, message->bytes, message->utime);
      if (options_.progress) options_.progress(reader.progress());
      if (!decoded.event) continue;
      write_closures(message->utime - 1);
      if (const auto* robot = std::get_if<RobotEvent>(&decoded.event->body)) {
        robots_[robot->robot].laser = robot->laser;
      } else if (const auto* scan = std::get_if<ScanEvent>(&decoded.event->body)) {
        write_poses(scan->scan.utime);
        write_scan(*scan);
        note_stamp(scan->scan.utime);
      }
    }
  }

  void write_scan(const ScanEvent& event) {
    const auto robot = robots_.find(event.robot);
    if (robot == robots_.end() || !robot->second.scan || !robot->second.laser) return;
    writer_.write(*robot->second.scan, nanoseconds(event.scan.utime),
                  foxglove::laser_scan(event.scan, *robot->second.laser, event.robot + "/laser"));
  }

  void note_stamp(std::int64_t utime) { newest_utime_ = std::max(newest_utime_, utime); }

  void write_poses(std::int64_t utime) {
    for (const TrajectoryRow* row = rows_.peek(); row && row->utime <= utime; row = rows_.peek()) {
      write_pose(*row);
      note_stamp(row->utime);
      rows_.pop();
    }
  }

  /// Those that were decided by then, by the clock of what came.
  void write_closures(std::int64_t utime) {
    for (; next_closure_ < closures_.size() && closures_[next_closure_]->end_utime <= utime; ++next_closure_)
      write_closure(*closures_[next_closure_]);
  }

  void write_pose(const TrajectoryRow& row) {
    const auto session = static_cast<std::size_t>(row.session),
               patch = static_cast<std::size_t>(row.patch.value);
    const int island = islands_.rank(row.patch);
    if (session >= map_.sessions.size() || patch >= map_.poses.size() || island < 0) return;
    const std::string& name = map_.sessions[session].robot;
    const Robot& robot = robots_.at(name);
    const std::string frame = foxglove::island_frame(island);
    const Pose island_from_robot = map_.poses[patch] * row.patch_from_robot;
    std::vector<foxglove::Transform> frames = {{frame, name, island_from_robot}};
    if (robot.laser) frames.push_back({name, name + "/laser", robot.laser->robot_from_laser});
    writer_.write(transforms_, nanoseconds(row.utime), foxglove::frame_transforms(row.utime, frames));
    writer_.write(robot.pose, nanoseconds(row.utime),
                  foxglove::pose_in_frame(row.utime, frame, island_from_robot));
  }

  void write_closure(const ClosureRecord& closure) {
    writer_.write(
        log_, nanoseconds(newest_utime_),
        foxglove::log(newest_utime_, foxglove::closure_level(closure), foxglove::closure_text(closure)));
  }

  const MapCopy& map_;
  RankedIslands islands_;
  const McapOptions& options_;
  ChannelNames channel_names_;
  Rows rows_;
  McapWriter writer_;
  std::map<std::string, Robot> robots_;
  std::uint16_t transforms_ = 0, scene_ = 0, log_ = 0;
  std::vector<const ClosureRecord*> closures_;
  std::size_t next_closure_ = 0;
  std::int64_t newest_utime_ = 0;  ///< of the robots' stamps so far
};

}  // namespace

std::uint64_t write_mcap(const MapCopy& map, const Configuration& configuration, const std::string& path,
                         const McapOptions& options) {
  return MapMcap(map, configuration, path, options).write();
}

}  // namespace isthmus
