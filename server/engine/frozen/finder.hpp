#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "server/engine/frozen/lost_robot.hpp"
#include "server/engine/places/place_searcher.hpp"
#include "server/engine/places/recent_way.hpp"
#include "server/engine/robot/robot.hpp"

namespace isthmus {

/// Where on a map that does not change a robot may be: places all over its islands, so near one another that
/// windows about them leave nothing out.
std::vector<RigidPiece> all_places(const Map& map, const EngineOptions& options);

/// What the search for robots did.
struct FinderCounts {
  std::int64_t queries = 0;
  std::int64_t places_searched = 0;
  std::int64_t ambiguous = 0;  ///< queries that fit two places about as well
  std::int64_t finds = 0;
};

/// Finds a robot that is somewhere on a map, nobody knows where. Meanwhile it is mapped by itself, on a
/// sketch beside the map; with each patch of the sketch, what lies on the last metres of its way is searched
/// for all over the map, in bounded steps. It is found where that fits in one place only, and another piece
/// of the way says the same.
class Finder {
 public:
  /// The next scan of the robot.
  void take_scan(const Robot& robot, Observation observation, const Pose& odom_from_robot,
                 const EngineOptions& options);

  bool has_work() const { return due_ || query_.has_value(); }
  /// One bounded piece of the search; what it costs, in nominal microseconds.
  std::int64_t step(const Map& map, const std::vector<RigidPiece>& places, const EngineOptions& options,
                    FinderCounts& counts);

  /// Where on the map the robot was at its last scan, if it was found since this was last asked.
  std::optional<ManifoldPose> take_found();

  /// Why it is not found yet.
  NotFound why(const FinderOptions& options) const;
  double way_m() const { return way_.length_m(); }

  /// Since when its odometry tells where it was at one time as seen from another: it was not carried away.
  std::int64_t since_utime() const { return since_utime_; }

 private:
  /// How the sketch lies on the map, by one find.
  struct Sighted {
    PatchId query;   ///< patch of the sketch that was found
    PatchId newest;  ///< of the way that was searched for
    ManifoldPose pose;
    Pose map_from_sketch;
    IslandId island;
  };

  void note_patch(const EngineOptions& options);
  void begin(const std::vector<RigidPiece>& places, const EngineOptions& options);
  void take(const Map& map, const Find& find, const EngineOptions& options);
  Pose sketch_from_robot() const { return sketch_.manifold().project(robot_.place->pose); }

  Map sketch_;
  Robot robot_;  ///< on the sketch
  std::int64_t since_utime_ = 0;
  RecentWay way_;
  bool due_ = false;
  std::optional<PlaceSearcher> query_;
  std::deque<Sighted> sighted_;
  std::optional<Sighted> found_;
  std::optional<NotFound> decided_;  ///< by the newest search that came to its end
};

}  // namespace isthmus
