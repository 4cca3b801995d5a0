#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "server/engine/input/configuration.hpp"
#include "server/engine/input/event.hpp"
#include "server/engine/map/map.hpp"
#include "server/engine/record/map_copy.hpp"
#include "server/engine/robot/odometry_track.hpp"

namespace isthmus {

/// The last pass over a log: matches every scan with the map as it is at the end, where while it was made
/// each was matched with what there was, and carried along with its patch since. What nothing matches between
/// two scans that something does is bridged by odometry, from both ends (bridge.hpp): while the map was made,
/// there was only the one before. The map itself stays as it is.
class Refinement {
 public:
  /// Of the trajectory in `map`, made with this configuration.
  Refinement(const MapCopy& map, const Configuration& configuration);

  /// The log's events again, in their order; others than robots' declarations, odometry and scans do nothing.
  void take(const Event& event);

  /// All rows, those of scans seen again where they now lie. Throws std::runtime_error where no temporary
  /// file can be made.
  std::shared_ptr<const TrajectoryStore> finish();
  std::size_t refined() const { return refined_; }

 private:
  void take(const RobotEvent& robot);
  void take(const OdometryEvent& odometry);
  void take(const ScanEvent& scan);
  /// Where a scan lies in its row's patch, if it fits there.
  std::optional<Pose> match(std::span<const ScanPoint> points, const TrajectoryRow& row);
  /// What is determined with respect to a patch (eq. 12), where it lies in the patch's frame.
  const std::vector<LocalPatch>& well_determined_around(PatchId patch);
  LocalMap local_map(const TrajectoryRow& row, std::span<const ScanPoint> points);
  Pose map_from_robot(std::size_t row) const;
  void bridge_gaps();
  /// Rows of one robot in order, of which only the first and the last are matched.
  void bridge_gap(std::span<const std::size_t> rows);

  const Configuration configuration_;
  const EngineOptions& options_ = configuration_.engine;
  Map map_;
  std::map<std::string, Laser> lasers_;
  std::vector<TrajectoryRow> rows_;
  std::map<std::pair<std::string, std::int64_t>, std::size_t> row_of_;  ///< by robot and stamp
  std::vector<bool> matched_;                                           ///< by row
  std::vector<std::optional<Pose>> odom_from_robot_;                    ///< by row
  std::map<std::string, OdometryTrack> odometry_;
  std::map<std::string, std::vector<std::size_t>> untold_;  ///< rows whose odometry is still to come
  std::map<PatchId, std::vector<LocalPatch>> well_determined_;
  std::size_t refined_ = 0;
};

}  // namespace isthmus
