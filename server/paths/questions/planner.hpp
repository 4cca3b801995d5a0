#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <tuple>
#include <vector>

#include "patches/manifold.hpp"
#include "server/paths/ground/ground_keeper.hpp"
#include "server/paths/questions/path.hpp"
#include "server/paths/roads/roadmap.hpp"

namespace isthmus {

/// bad_value where it is none, or larger than `Planner::max_room_m`; or none.
Refusal check(const Footprint& footprint);

struct PathQuestion {
  ManifoldPose from;
  ManifoldPose to;
  Footprint footprint;
  double start_tolerance_m = 0.6;  ///< a robot that stands closer to something than asked leaves it first
  double goal_tolerance_m = 0.5;   ///< of the path's end from `to`, where the footprint does not fit there
};

/// Answers questions about paths over a map, by copies of it. Bounded work: each question opens each square
/// of the island's ground once at most, and no more than `max_steps`. Not thread-safe.
class Planner {
 public:
  static constexpr std::size_t max_steps = 1'000'000;
  /// Of a question's radius with clearance, in metres.
  static constexpr double max_room_m = Ground::reach_m - ground_cell_m;

  /// The map that questions are answered by from now on.
  void update(std::shared_ptr<const MapCopy> map);
  /// Made when first asked for, and where the ground has changed since; at most eight are kept.
  std::shared_ptr<const Roadmap> roadmap(IslandId island, const Footprint& footprint);
  const MapCopy& map() const { return *map_; }
  const Zones& zones() const { return zones_; }
  /// Of the map.
  const NearPatches& near() const { return *grounds_.near(); }

  /// Its poses are a metre apart at most. Refused: bad_value, unknown_patch, other_island, no_ground,
  /// kept_out, no_room, unreachable, too_long.
  Path path(const PathQuestion& question);

  /// The cell nearest to a pose, no farther than a distance in metres, at which the footprint fits; -1: none.
  NodeId room_near(const Roadmap& roadmap, const ManifoldPose& pose, double within_m) const;
  Pose project(const ManifoldPose& pose) const;

 private:
  std::shared_ptr<const Roadmap> roadmap(IslandId island, const Footprint& footprint, bool with_zones);
  Refusal why_not(IslandId island, const PathQuestion& question, Refusal otherwise);
  Path answer(const Roadmap& roadmap, const PathQuestion& question, const std::vector<NodeId>& way) const;

  struct KeptRoadmap {
    std::shared_ptr<const Roadmap> roadmap;
    std::int64_t asked = 0;
  };
  using Key = std::tuple<IslandId, double, double, bool>;  ///< island, radius, clearance, with zones

  GroundKeeper grounds_;
  std::shared_ptr<const MapCopy> map_ = std::make_shared<MapCopy>();
  Zones zones_;
  std::map<Key, KeptRoadmap> roadmaps_;
  std::int64_t asked_ = 0;
};

}  // namespace isthmus
