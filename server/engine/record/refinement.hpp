#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/engine/input/configuration.hpp"
#include "server/engine/input/event.hpp"
#include "server/engine/map/map.hpp"
#include "server/engine/record/map_copy.hpp"

namespace isthmus {

/// The last pass over a log: matches every scan with the map as it is at the end, where while it was made
/// each was matched with what there was, and carried along with its patch since. The map itself stays as it
/// is.
class Refinement {
 public:
  /// Of the trajectory in `map`, made with this configuration.
  Refinement(const MapCopy& map, const Configuration& configuration);

  /// The log's events again, in their order; others than robots' declarations and scans do nothing.
  void take(const Event& event);

  /// All rows, those of scans seen again where they now lie. Throws std::runtime_error where no temporary
  /// file can be made.
  std::shared_ptr<const TrajectoryStore> finish();
  std::size_t refined() const { return refined_; }

 private:
  void take(const RobotEvent& robot);
  void take(const ScanEvent& scan);
  /// What is determined with respect to a patch (eq. 12), where it lies in the patch's frame.
  const std::vector<LocalPatch>& well_determined_around(PatchId patch);
  LocalMap local_map(const TrajectoryRow& row, std::span<const ScanPoint> points);

  const Configuration configuration_;
  const EngineOptions& options_ = configuration_.engine;
  Map map_;
  std::map<std::string, Laser> lasers_;
  std::vector<TrajectoryRow> rows_;
  std::map<std::pair<std::string, std::int64_t>, std::size_t> row_of_;  ///< by robot and stamp
  std::map<PatchId, std::vector<LocalPatch>> well_determined_;
  std::size_t refined_ = 0;
};

}  // namespace isthmus
