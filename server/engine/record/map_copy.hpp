#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "patches/manifold.hpp"
#include "relations/graph.hpp"
#include "server/engine/annotations/annotation.hpp"
#include "server/engine/closures/closure_record.hpp"
#include "server/engine/hypotheses/find_record.hpp"
#include "server/engine/hypotheses/hypothesis_counts.hpp"
#include "server/engine/record/counters.hpp"
#include "server/engine/record/trajectory_store.hpp"
#include "server/engine/rendezvous/meeting_record.hpp"
#include "server/engine/robot/health_warnings.hpp"
#include "server/engine/robot/session.hpp"
#include "server/engine/sightings/sighting_log.hpp"
#include "server/engine/sightings/tag_record.hpp"

namespace isthmus {

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
  std::vector<ClosureId> forbidden;           ///< by id: of these, those that operators have forbidden
  std::vector<PatchId> left_out;              ///< by id: patches whose robot's data operators have dropped
  std::vector<AnnotationRecord> annotations;  ///< by name
  Counters counters;
  HypothesisCounts hypotheses;
  std::vector<FindRecord> finds;         ///< of scans, the newest last
  std::optional<MeetingRecord> meeting;  ///< to be driven to
  std::vector<HealthRecord> health;      ///< of declared robots, by name
  std::size_t feature_islands = 0;       ///< islands without patches: maps of features
};

/// Whether operators have dropped a patch's data.
inline bool is_left_out(const MapCopy& map, PatchId patch) {
  return std::ranges::binary_search(map.left_out, patch);
}

/// SHA-256, in hex, over patches, accepted relations and closures by id, numbers as the bits of f64; and over
/// the ids of patches that operators have dropped, and places and zones, if any.
std::string map_sha256(const MapCopy& map);

}  // namespace isthmus
