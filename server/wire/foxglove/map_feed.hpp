#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "isthmus/status_t.hpp"
#include "server/engine/input/event.hpp"
#include "server/engine/record/map_copy.hpp"
#include "server/engine/robot/robot_pose.hpp"
#include "server/output/foxglove/map_content.hpp"
#include "server/wire/foxglove/broadcast.hpp"

namespace isthmus::foxglove {

/// Makes messages of what the live server shows, of those that somebody listens to
/// (server/output/foxglove/README.md lists them). Islands are numbered by their lowest patch. One thread.
class MapFeed {
 public:
  using Clock = std::chrono::steady_clock;
  struct Options {
    double grid_cell_m = 0.05;
    std::chrono::milliseconds grid_interval{2000};   ///< of each island's grid, at least
    std::chrono::milliseconds scene_interval{2000};  ///< at least
    std::size_t grids = 100;                         ///< of the islands with most patches
  };

  explicit MapFeed(Broadcast& broadcast) : MapFeed(broadcast, Options()) {}
  MapFeed(Broadcast& broadcast, Options options);

  void show(const RobotPose& pose);
  void show(const RobotEvent& robot);
  void show(const ScanEvent& scan);
  void show(const MapCopy& map, const status_t& status, Clock::time_point now);

  /// Whether somebody listens to scans.
  bool wants_scans() const;

 private:
  struct Drawn {
    Clock::time_point when;
    std::vector<Pose> poses;  ///< of its patches
  };
  struct Robot {
    std::optional<Laser> laser;
    std::optional<RobotPose> newest;
  };

  Robot& robot(const std::string& name);
  std::vector<Island> islands_of(const MapCopy& map) const;
  void show_frames(const MapCopy& map, const std::vector<Island>& islands, std::int64_t utime);
  void show_grids(const MapCopy& map, const std::vector<Island>& islands, std::int64_t utime,
                  Clock::time_point now);
  void show_scene(const MapCopy& map, const std::vector<Island>& islands, std::int64_t utime,
                  Clock::time_point now);
  void tell_closures(const MapCopy& map, std::int64_t utime);
  void tell_warnings(const status_t& status);

  Broadcast& broadcast_;
  Options options_;
  std::map<std::string, Robot> robots_;
  std::map<std::string, Drawn> grids_;  ///< by frame, that have a channel
  std::set<std::string> scene_frames_;  ///< that are shown
  std::vector<Scene> scene_;            ///< as it was sent last
  Clock::time_point scene_sent_;
  std::map<ClosureId, ClosureState> closures_;
  std::set<std::string> warnings_;  ///< that hold
};

}  // namespace isthmus::foxglove
