#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/engine/record/map_copy.hpp"
#include "tools/simulate/truth/truth_files.hpp"

namespace isthmus {

/// A map's final trajectories, against the truth; poses are those of the nearest stamp within 0.1 s.
class TrajectoryErrors {
 public:
  explicit TrajectoryErrors(const MapCopy& map);

  /// By how much the relation's translation is off; nothing where the map has no opinion: no pose, or poses
  /// on two islands.
  std::optional<double> error_m(const ScanRelation& relation) const;
  /// The island that a robot was on.
  std::optional<IslandId> island(const std::string& robot, std::int64_t utime) const;

 private:
  struct Row {
    std::int64_t utime = 0;
    IslandId island;
    Pose map_from_robot;
  };
  const Row* nearest(const std::string& robot, std::int64_t utime) const;

  std::map<std::string, std::vector<Row>> rows_;
};

}  // namespace isthmus
