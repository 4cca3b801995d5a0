#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "patches/manifold.hpp"
#include "relations/graph.hpp"
#include "server/engine/closures/closure_record.hpp"
#include "server/engine/hypotheses/hypothesis_counts.hpp"
#include "server/engine/record/trajectory_store.hpp"
#include "server/engine/rendezvous/meeting_record.hpp"
#include "server/engine/robot/health_warnings.hpp"
#include "server/engine/robot/session.hpp"
#include "server/engine/sightings/sighting_log.hpp"

namespace isthmus {

struct TagRecord {
  std::int32_t barcode = -1;
  IslandId island;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< in the island's frame
  Eigen::Matrix2d covariance =
      Eigen::Matrix2d::Zero();  ///< relative to the island's first patch; set by exports
  bool placed = false;
  PatchId patch;  ///< its patch on the map, a point; none while it is not placed
};

/// What the engine counted, from its first event on. Keys of the maps are reasons, lower_case.
struct Counters {
  std::int64_t events = 0;
  std::int64_t scans = 0;
  std::int64_t scans_matched = 0;
  std::map<std::string, std::int64_t> scans_predicted;  ///< placed by odometry alone, by reason
  std::int64_t sightings = 0;
  std::map<std::string, std::int64_t> dropped;  ///< messages, by reason
  std::map<std::string, std::map<std::string, std::int64_t>> dropped_by_robot;
  std::int64_t first_receive_utime = 0;
  std::int64_t last_receive_utime = 0;

  auto members() {
    return std::tie(events, scans, scans_matched, scans_predicted, sightings, dropped, dropped_by_robot,
                    first_receive_utime, last_receive_utime);
  }
};

/// A consistent copy of the map, cheap (patches are shared), for exports and publishing off the engine's
/// thread.
struct MapCopy {
  std::vector<PatchPtr> patches;  ///< by id
  std::vector<Pose> poses;        ///< by patch id, in the island's frame
  RelationGraph graph;
  std::vector<Session> sessions;
  std::shared_ptr<const TrajectoryStore> trajectory;  ///< rows of all sessions up to `trajectory_rows`
  std::size_t trajectory_rows = 0;
  SightingLog sightings;
  std::vector<TagRecord> tags;
  std::vector<ClosureRecord> closures;
  std::vector<PatchId> left_out;  ///< by id: patches whose robot's data operators have dropped
  Counters counters;
  HypothesisCounts hypotheses;
  std::optional<MeetingRecord> meeting;  ///< to be driven to
  std::vector<HealthRecord> health;      ///< of declared robots, by name
};

/// SHA-256, in hex, over patches, accepted relations and closures by id, numbers as the bits of f64; and over
/// the ids of patches that operators have dropped, if any.
std::string map_sha256(const MapCopy& map);

}  // namespace isthmus
