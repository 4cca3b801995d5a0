#include "server/engine/engine_state.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/engine/localise/footprints.hpp"
#include "server/engine/robot/teammates.hpp"

namespace isthmus {
namespace {

bool same_laser(const Laser& a, const Laser& b) {
  return a.robot_from_laser == b.robot_from_laser && a.range_min_m == b.range_min_m &&
         a.range_max_m == b.range_max_m;
}

}  // namespace

void EngineState::configure(Configuration given) {
  configuration = std::move(given);
  robots.clear();
  for (const auto& [name, robot] : configuration.robots) {
    Robot& known = with_name(name);
    known.declaration = robot.robot;
    known.declared = robot.declared;
  }
}

Robot& EngineState::with_name(const std::string& name) {
  const auto [robot, is_new] = robots.try_emplace(name);
  if (is_new) robot->second.noise = OdometryNoise(configuration.engine.odometry_noise);
  return robot->second;
}

DropReason EngineState::drop(const std::string& robot, DropReason reason, std::int64_t messages) {
  counters.dropped[reason] += messages;
  // Anybody can make up names: strangers are counted together, and names beyond so many too.
  constexpr std::size_t max_names = 256;
  const bool countable =
      robots.contains(robot) ||
      (reason != DropReason::unknown_robot &&
       (counters.dropped_by_robot.contains(robot) || counters.dropped_by_robot.size() < max_names));
  if (!robot.empty()) counters.dropped_by_robot[countable ? robot : "(others)"][reason] += messages;
  return reason;
}

Outcome EngineState::take(const ConfigurationEvent& event) {
  if (counters.events > 1) return {drop("", DropReason::late_configuration), {}};
  auto parsed = parse_configuration(event.toml, "configuration");
  if (std::holds_alternative<std::string>(parsed)) return {drop("", DropReason::bad_configuration), {}};
  configure(std::get<Configuration>(std::move(parsed)));
  return {};
}

Outcome EngineState::take(const RobotEvent& event) {
  for (const auto& [name, other] : robots) {
    if (event.barcode >= 0 && name != event.robot && other.declared &&
        other.declaration.barcode == event.barcode) {
      return {drop(event.robot, DropReason::barcode_taken), {}};
    }
  }
  Robot& robot = with_name(event.robot);
  // What the configuration says of a robot stands against what the robot says.
  const auto configured = configuration.robots.find(event.robot);
  const bool fixed = configured != configuration.robots.end() && configured->second.declared;
  Outcome outcome;
  if (!fixed && robot.declared && !same_laser(event.laser, robot.declaration.laser)) {
    // What was measured by the laser as it was is not to be read as one of the laser as it is.
    answer_pending(robot, outcome, true);
    robot.way.clear();
  }
  if (!fixed) robot.declaration = event;
  robot.declared = true;
  if (event.restarted) begin_anew(robot);
  return outcome;
}

// The robot was switched off and on: its odometry has another origin.
void EngineState::begin_anew(Robot& robot) {
  for (std::size_t i = 0; i < robot.pending.size(); ++i) drop(robot.declaration.robot, DropReason::restarted);
  robot.pending.clear();
  handling->restarted(robot);
  robot.odometry.clear();
}

Outcome EngineState::take(const TagEvent& event) {
  tags.insert(event.barcode);
  return {};
}

Outcome EngineState::take(const OdometryEvent& event) {
  Robot* robot = declared(event.robot);
  if (!robot) return {drop(event.robot, DropReason::unknown_robot), {}};
  robot->odometry.add(event.utime, event.odom_from_robot);
  robot->health.heard_stamp(event.utime, counters.last_receive_utime);
  robot->health.heard_odometry(event.odom_from_robot);
  Outcome outcome;
  if (!has_no_laser(*robot)) return outcome;
  const DropReason reason = handling->take_way(*robot, event, outcome);
  if (reason != DropReason::none) outcome.drop_reason = drop(event.robot, reason);
  return outcome;
}

Outcome EngineState::take(const ScanEvent& event) {
  Robot* robot = declared(event.robot);
  if (!robot) return {drop(event.robot, DropReason::unknown_robot), {}};
  const Scan& scan = event.scan;
  robot->health.heard_stamp(scan.utime, counters.last_receive_utime);
  robot->health.heard_scan(scan, robot->declaration.laser, configuration.engine.match,
                           configuration.engine.health);
  if (has_no_laser(*robot)) return {drop(event.robot, DropReason::no_laser), {}};
  if (scan.ranges_m.empty() || scan.bearing_step_rad == 0)
    return {drop(event.robot, DropReason::zero_beams), {}};
  const bool first = robot->last_scan_utime == 0;
  if (!first && scan.utime == robot->last_scan_utime)
    return {drop(event.robot, DropReason::duplicate_stamp), {}};
  if (!first && scan.utime < robot->newest_scan_utime - configuration.engine.intake.backward_us) {
    if (++robot->stale_scans < configuration.engine.intake.max_stale_scans)
      return {drop(event.robot, DropReason::stale_stamp), {}};
    handling->forget_place(*robot);
    robot->newest_scan_utime = scan.utime;
  }
  robot->stale_scans = 0;
  robot->last_scan_utime = scan.utime;
  robot->newest_scan_utime = first ? scan.utime : std::max(robot->newest_scan_utime, scan.utime);
  ++counters.scans;
  robot->pending.push_back({scan, counters.last_receive_utime});
  return {};
}

Outcome EngineState::take(const SightingEvent& event) {
  ++counters.sightings;
  const Robot* observer = declared(event.robot);
  const auto refuse = [&](Reason reason, DropReason drop_reason) {
    handling->refuse_sighting(event, reason);
    return Outcome{drop(event.robot, drop_reason), {}};
  };
  if (!observer) return refuse(Reason::unknown_robot, DropReason::unknown_robot);
  if (observer->declaration.barcode == event.barcode)
    return refuse(Reason::sees_itself, DropReason::sees_itself);
  const auto worn = std::ranges::find_if(robots, [&](const auto& entry) {
    return entry.second.declared && entry.second.declaration.barcode == event.barcode;
  });
  const bool is_tag = tags.contains(event.barcode) || configuration.any_tag;
  if (worn == robots.end() && !is_tag) return refuse(Reason::unknown_barcode, DropReason::unknown_barcode);
  const std::string target = worn != robots.end() ? worn->first : tag_name(event.barcode);
  if (worn != robots.end()) {
    Robot& seer = robots.at(event.robot);
    // One with a stamp of another time says nothing of who stands there now.
    const bool now = !seer.odometry.empty() && std::abs(event.utime - seer.odometry.newest_utime()) <=
                                                   configuration.engine.intake.teammate_stamp_us;
    std::optional<Pose> odometry = seer.odometry.at(event.utime);
    if (!odometry) odometry = seer.odometry.newest();
    if (now) note_teammate(seer, event, target, *odometry);
    rendezvous.take_sighting(event.robot, target);
  }
  const DropReason reason = handling->take_sighting(event, target, worn == robots.end());
  if (reason != DropReason::none) return {drop(event.robot, reason), {}};
  return {};
}

Outcome EngineState::take(const CommandEvent& event) {
  if (event.verb == Verb::send_map) return {};  // for whoever publishes it
  const DropReason reason = handling->obey(event);
  if (reason != DropReason::none) return {drop("", reason), {}};
  return {};
}

Outcome EngineState::take(const AnnotationEvent& event) {
  // A finished map's journal is only read: what was written on it would be gone with the server.
  const DropReason reason = handling->maps() ? annotations.take(event, map, is_on_map()) : DropReason::frozen;
  if (reason != DropReason::none) return {drop("", reason), {}};
  return {};
}

Outcome EngineState::take(const InitialPoseEvent& event) {
  Robot* robot = declared(event.robot);
  if (!robot) return {drop(event.robot, DropReason::unknown_robot), {}};
  const DropReason reason = handling->take_initial_pose(*robot, event);
  if (reason != DropReason::none) return {drop(event.robot, reason), {}};
  return {};
}

void EngineState::answer_pending(Robot& robot, Outcome& outcome, bool no_more_waiting) {
  const IntakeOptions& intake = configuration.engine.intake;
  while (!robot.pending.empty()) {
    const PendingScan& waiting = robot.pending.front();
    std::optional<Pose> odometry = robot.odometry.at(waiting.scan.utime);
    if (!odometry) {
      const bool waited = no_more_waiting || robot.pending.size() > intake.max_pending_scans ||
                          counters.last_receive_utime > waiting.receive_utime + intake.odometry_wait_us ||
                          (!robot.odometry.empty() && robot.odometry.newest_utime() > waiting.scan.utime);
      if (!waited) return;
      odometry = robot.odometry.newest();
    }
    const Scan scan = std::move(robot.pending.front().scan);
    robot.pending.pop_front();
    const DropReason refused = handling->refusal_of_scans(robot);
    if (odometry && refused == DropReason::none) {
      handling->take_scan(robot, scan, *odometry, outcome);
    } else {
      drop(robot.declaration.robot, refused == DropReason::none ? DropReason::no_odometry : refused);
    }
  }
}

void EngineState::answer_all(Outcome& outcome) {
  for (auto& [name, robot] : robots) answer_pending(robot, outcome, true);
}

Observation EngineState::observed(const Robot& robot, const Scan& scan, const Pose& odom_from_robot) const {
  const Laser& laser = robot.declaration.laser;
  std::vector<Body> bodies =
      teammates_around(map, robots, robot, odom_from_robot, scan.utime, configuration.engine.teammates);
  // What ends within its own is part of it, or touches it and may go where it goes: no place to know again.
  bodies.push_back({Eigen::Vector2d::Zero(), robot.declaration.footprint_radius_m});
  return observe(without_bodies(scan, laser, bodies), laser, configuration.engine.patch);
}

void EngineState::count_scan(Unmatched unmatched) {
  if (unmatched == Unmatched::no) {
    ++counters.scans_matched;
  } else {
    ++counters.scans_predicted[unmatched];
  }
}

void EngineState::begin_session(Robot& robot, const RobotPose& pose) {
  robot.session = static_cast<std::int32_t>(sessions.size());
  Session session;
  session.robot = robot.declaration.robot;
  session.number = robot.session;
  session.from_utime = robot.unplaced.empty() ? pose.utime : robot.unplaced.front().utime;
  session.first_patch = pose.pose.patch;
  sessions.push_back(session);
}

void EngineState::keep_pose(Robot& robot, ScanOutcome done, const Pose& odom_from_robot, Outcome& outcome) {
  const std::int64_t utime = done.pose.utime;
  sessions[static_cast<std::size_t>(robot.session)].to_utime = utime;
  if (done.unplaced) {
    robot.unplaced.push_back({utime, odom_from_robot});
  } else {
    record(robot, done.pose.pose, odom_from_robot);
    robot.history.add({utime, robot.session, done.pose.pose, done.pose.covariance, odom_from_robot},
                      configuration.engine.pose_history);
    trajectory->append({utime, robot.session, done.pose.pose.patch, done.pose.pose.patch_from_object});
  }
  outcome.poses.push_back(std::move(done.pose));
}

void EngineState::record(Robot& robot, const ManifoldPose& pose, const Pose& odom_from_robot) {
  for (const UnplacedScan& scan : robot.unplaced) {
    const Pose now_from_then = ominus(scan.odom_from_robot, odom_from_robot);
    trajectory->append({scan.utime, robot.session, pose.patch, pose.patch_from_object * now_from_then});
  }
  robot.unplaced.clear();
}

// The rows since then, and with them some from before.
void EngineState::correct(std::int64_t since_utime, const Change& change) {
  constexpr std::size_t at_once = 4096;
  trajectory->flush();
  bool is_since = true;
  for (std::size_t end = trajectory->size(); end > 0 && is_since;) {
    const std::size_t first = end - std::min(end, at_once);
    const std::vector<TrajectoryRow> rows = trajectory->read(first, end - first);
    is_since = rows.empty();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      PastPlace place{rows[i].utime, rows[i].session, {rows[i].patch, rows[i].patch_from_robot}, {}, {}};
      is_since = is_since || place.utime >= since_utime;
      if (change(sessions[static_cast<std::size_t>(place.session)].robot, place))
        trajectory->correct({first + i, place.pose.patch, place.pose.patch_from_object});
    }
    end = first;
  }
}

}  // namespace isthmus
