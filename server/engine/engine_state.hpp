#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "server/engine/annotations/annotations.hpp"
#include "server/engine/closures/closures.hpp"
#include "server/engine/handling.hpp"
#include "server/engine/hypotheses/hypotheses.hpp"
#include "server/engine/input/configuration.hpp"
#include "server/engine/localise/mapper.hpp"
#include "server/engine/map/island_fits.hpp"
#include "server/engine/propagation/proximity_matching.hpp"
#include "server/engine/record/counters.hpp"
#include "server/engine/record/trajectory_store.hpp"
#include "server/engine/rendezvous/rendezvous.hpp"
#include "server/engine/robot/session.hpp"

namespace isthmus {

/// All that the engine knows.
struct EngineState final : RecordedWays {
  Configuration configuration;
  Map map;
  std::map<std::string, Robot> robots;
  std::vector<Session> sessions;
  std::shared_ptr<TrajectoryStore> trajectory = std::make_shared<TrajectoryStore>();
  Closures closures;
  Hypotheses hypotheses;
  IslandFits island_fits;
  ProximityMatching proximity_matching;
  Rendezvous rendezvous;
  Annotations annotations;
  std::set<std::int32_t> tags;  // declared barcodes
  Counters counters;
  std::set<std::string> starts_related;
  bool refine_asked = false;  ///< once nothing is left to match, all is to be fitted
  struct Dropped {
    std::vector<Relation> relations;
    PatchId end;  // patches made since are not meant

    auto members() { return std::tie(relations, end); }
  };
  std::map<std::string, Dropped> dropped;  // by robot
  std::unique_ptr<Handling> handling;      ///< not in snapshots, which are of engines that map

  /// Without a handling: who makes the state gives it one.
  explicit EngineState(Configuration given) { configure(std::move(given)); }

  void configure(Configuration given);
  /// The robot of that name; a new one, with what is known of none, where there is none yet.
  Robot& with_name(const std::string& name);

  World world() { return {map, robots, configuration.engine, counters.last_receive_utime, false, this}; }
  void correct(std::int64_t since_utime, const Change& change) override;

  /// Counts what is dropped, and returns why.
  DropReason drop(const std::string& robot, DropReason reason, std::int64_t messages = 1);

  Robot* declared(const std::string& name) {
    const auto found = robots.find(name);
    return found == robots.end() || !found->second.declared ? nullptr : &found->second;
  }

  /// Whether operators have dropped the data of its robot since it was made.
  bool is_left_out(PatchId patch) const {
    const auto drop = dropped.find(map.manifold().patch(patch).robot);
    return drop != dropped.end() && patch < drop->second.end;
  }
  IsOnMap is_on_map() const {
    return [this](PatchId patch) { return !is_left_out(patch); };
  }

  /// For every body: whether it is of a robot that has not introduced itself.
  template <class Body>
  bool is_stranger(const Body& body) {
    constexpr bool of_robot = std::is_same_v<Body, OdometryEvent> || std::is_same_v<Body, ScanEvent> ||
                              std::is_same_v<Body, SightingEvent> || std::is_same_v<Body, InitialPoseEvent>;
    if constexpr (of_robot) return declared(body.robot) == nullptr;
    return false;
  }

  Outcome take(const ConfigurationEvent& event);
  Outcome take(const RobotEvent& event);
  Outcome take(const TagEvent& event);
  Outcome take(const OdometryEvent& event);
  Outcome take(const ScanEvent& event);
  Outcome take(const SightingEvent& event);
  Outcome take(const CommandEvent& event);
  Outcome take(const TickEvent&) { return {}; }
  Outcome take(const AnnotationEvent& event);
  Outcome take(const InitialPoseEvent& event);

  /// A robot that says that it was restarted.
  void begin_anew(Robot& robot);
  /// Hands over a robot's scans whose odometry has come, or is waited for no longer.
  void answer_pending(Robot& robot, Outcome& outcome, bool no_more_waiting);
  void answer_all(Outcome& outcome);

  /// What a scan shows beside other robots.
  Observation observed(const Robot& robot, const Scan& scan, const Pose& odom_from_robot) const;
  void count_scan(Unmatched unmatched);
  void begin_session(Robot& robot, const RobotPose& pose);
  /// Keeps where the robot is after a scan, and answers it.
  void keep_pose(Robot& robot, ScanOutcome done, const Pose& odom_from_robot, Outcome& outcome);
  /// Rows of the trajectory for scans that waited for the robot to be found again.
  void record(Robot& robot, const ManifoldPose& pose, const Pose& odom_from_robot);

  /// For snapshots, which are not made of frozen maps: all but the configuration, the trajectory and the
  /// annotations, which follow where there are any.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(map, robots, sessions, closures, hypotheses, island_fits, proximity_matching, rendezvous, tags,
            counters, starts_related, refine_asked, dropped);
  }
};

}  // namespace isthmus
