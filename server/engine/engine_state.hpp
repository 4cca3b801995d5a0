#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "server/engine/closures/closures.hpp"
#include "server/engine/engine.hpp"
#include "server/engine/frozen/frozen.hpp"
#include "server/engine/hypotheses/hypotheses.hpp"
#include "server/engine/localise/mapper.hpp"
#include "server/engine/map/settling.hpp"
#include "server/engine/propagation/weaving.hpp"
#include "server/engine/rendezvous/rendezvous.hpp"

namespace isthmus {

/// All that the engine knows.
struct Engine::State {
  Configuration configuration;
  Map map;
  std::map<std::string, Robot> robots;
  std::vector<Session> sessions;
  std::shared_ptr<TrajectoryStore> trajectory = std::make_shared<TrajectoryStore>();
  Closures closures;
  Hypotheses hypotheses;
  Settling settling;
  Weaving weaving;
  Rendezvous rendezvous;
  std::set<std::int32_t> tags;  // declared barcodes
  Counters counters;
  std::set<std::string> starts_related;
  bool refine_asked = false;  ///< when all is woven, all is to be fitted
  struct Dropped {
    std::vector<Relation> relations;
    PatchId end;  // patches made since are not meant

    auto members() { return std::tie(relations, end); }
  };
  std::map<std::string, Dropped> dropped;  // by robot
  std::optional<Frozen> frozen;            // the map changes no more

  /// What of finishing is next; not in snapshots, which are made of maps that go on.
  enum class FinishStage { scans, trial, searches, finds, sightings, weaving, fit };
  FinishStage finish_stage = FinishStage::scans;
  std::vector<std::vector<PatchId>> islands_to_fit;

  explicit State(Configuration given) { configure(std::move(given)); }

  void configure(Configuration given);
  /// The robot of that name; a new one, with what is known of none, where there is none yet.
  Robot& with_name(const std::string& name);

  World world() { return {map, robots, configuration.engine, counters.last_receive_utime, false}; }

  std::string drop(const std::string& robot, const std::string& reason);

  Robot* declared(const std::string& name) {
    const auto found = robots.find(name);
    return found == robots.end() || !found->second.declared ? nullptr : &found->second;
  }

  /// For every body: whether it is of a robot that has not introduced itself.
  template <class Body>
  bool is_stranger(const Body& body) {
    constexpr bool of_robot = std::is_same_v<Body, OdometryEvent> || std::is_same_v<Body, ScanEvent> ||
                              std::is_same_v<Body, SightingEvent>;
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

  /// A robot that says that it was restarted.
  void begin_anew(Robot& robot);
  /// Its odometry begins anew: nothing tells any longer where it is.
  void forget_place(Robot& robot);
  void work_on_map();

  void answer_pending(Robot& robot, Outcome& outcome, bool no_more_waiting);
  void map_scan(Robot& robot, const Scan& scan, const Pose& odom_from_robot, Outcome& outcome);
  void localise_scan(Robot& robot, const Scan& scan, const Pose& odom_from_robot, Outcome& outcome);
  void settle(Robot& robot, ScanOutcome done, const Pose& odom_from_robot, Outcome& outcome);
  void record(Robot& robot, const ManifoldPose& pose, const Pose& odom_from_robot);
  void relate_measured_starts();
  void map_changed(const std::vector<std::vector<PatchId>>& islands);
  void arrange_meeting();
  std::string obey(const CommandEvent& order);
  std::string drop_data(const std::string& name);
  std::string take_back_drop(const std::string& name);

  /// The next piece of what remains to be done at the end; false: that was the last.
  bool finish_step(Outcome& outcome);

  /// For snapshots, which are not made of frozen maps: all but the configuration and the trajectory.
  template <class Archive>
  void serialize(Archive& archive) {
    archive(map, robots, sessions, closures, hypotheses, settling, weaving, rendezvous, tags, counters,
            starts_related, refine_asked, dropped);
  }
};

}  // namespace isthmus
