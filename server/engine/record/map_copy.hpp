#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "patches/manifold.hpp"
#include "relations/graph.hpp"
#include "server/engine/record/trajectory_store.hpp"
#include "server/engine/robot/health_warnings.hpp"
#include "server/engine/sightings/sighting_log.hpp"

namespace isthmus {

/// One run of a robot between restarts; its patches are on one island (until merges).
struct Session {
  std::string robot;
  std::int32_t number = 0;  ///< index among all sessions of all robots
  std::int64_t from_utime = 0;
  std::int64_t to_utime = 0;  ///< last scan so far
  PatchId first_patch;        ///< none while nothing was mapped

  auto members() { return std::tie(robot, number, from_utime, to_utime, first_patch); }
};

struct TagRecord {
  std::int32_t barcode = -1;
  IslandId island;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< in the island's frame
  Eigen::Matrix2d covariance =
      Eigen::Matrix2d::Zero();  ///< relative to the island's first patch; set by exports
  bool placed = false;
  PatchId patch;  ///< its patch on the map, a point; none while it is not placed
};

/// A closure or merge, as report.json lists it.
struct ClosureRecord {
  ClosureId id;
  std::string kind;   ///< "closure", "merge"
  std::string state;  ///< "accepted", "refused", "waiting", "withdrawn"
  std::int64_t utime = 0;
  std::vector<std::string> robots;
  std::string reason;
  int patches_touched = 0;
  int work_steps = 0;
  std::int64_t start_utime = 0;  ///< event time
  std::int64_t end_utime = 0;

  auto members() {
    return std::tie(id, kind, state, utime, robots, reason, patches_touched, work_steps, start_utime,
                    end_utime);
  }
};

/// Where one robot is to stand at a meeting.
struct MeetingPlace {
  std::string robot;
  ManifoldPose pose;  ///< facing the other robot, if the hypothesis is true

  auto members() { return std::tie(robot, pose); }
};

/// A meeting of two robots that would settle a hypothesis.
struct MeetingRecord {
  ClosureId closure;  ///< the hypothesis
  MeetingPlace a;
  MeetingPlace b;
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

/// A robot's own data, and what looks wrong with it.
struct HealthRecord {
  std::string robot;
  HealthFigures figures;
  std::vector<HealthWarning> warnings;
};

/// What the search for hypotheses did.
struct HypothesisCounts {
  std::int64_t queries = 0;
  std::int64_t queries_dropped = 0;  ///< that never got their turn
  std::int64_t places_searched = 0;
  std::int64_t ambiguous = 0;  ///< queries that fit two places about as well
  std::int64_t finds = 0;
  std::int64_t proposed = 0;

  auto members() { return std::tie(queries, queries_dropped, places_searched, ambiguous, finds, proposed); }
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
