#include "server/feature_maps/mapper/feature_mapper.hpp"

#include <algorithm>
#include <cmath>

#include "server/feature_maps/output/feature_record.hpp"

namespace isthmus {
namespace {

std::int64_t stamp_of(const Event& event) {
  if (const auto* scan = std::get_if<ScanEvent>(&event.body)) return scan->scan.utime;
  return std::get<SightingEvent>(event.body).utime;
}

}  // namespace

FeatureMapOptions feature_map_options(FeatureMapKind kind) {
  FeatureMapOptions options;
  options.kind = kind;
  options.filter.association.probability = 0.999;
  options.filter.max_features = 1500;
  options.scan_features.noise.surface_sigma_m = 0.02;
  options.scan_features.segmentation.min_length_m = 1;
  options.fusion.points = false;  // barcodes
  options.engine.odometry_noise.first_scale = kind == FeatureMapKind::segments ? 2 : 3;
  return options;
}

FeatureMapper::FeatureMapper(const FeatureMapOptions& options) : options_(options) {}

void FeatureMapper::handle(const Event& event) {
  if (counts_.events++ == 0) counts_.first_receive_utime = event.receive_utime;
  counts_.last_receive_utime = std::max(counts_.last_receive_utime, event.receive_utime);
  if (const auto* robot = std::get_if<RobotEvent>(&event.body)) take(*robot);
  if (const auto* tag = std::get_if<TagEvent>(&event.body); tag && !tags_.contains(tag->barcode))
    record({MapInputKind::tag, -1, "", {}, tag->utime, std::make_shared<Event>(event), {}, 0});
  if (const auto* odometry = std::get_if<OdometryEvent>(&event.body)) take(*odometry);
  if (const auto* scan = std::get_if<ScanEvent>(&event.body)) wait(scan->robot, event);
  if (const auto* sighting = std::get_if<SightingEvent>(&event.body)) wait(sighting->robot, event);
  for (auto& [name, robot] : robots_) take_waiting(robot, event.receive_utime, false);
}

void FeatureMapper::finish() {
  for (auto& [name, robot] : robots_) take_waiting(robot, 0, true);
}

void FeatureMapper::record(MapInput input) {
  apply(input);
  inputs_.push_back(std::move(input));
}

/// Robots say it again every few seconds.
bool FeatureMapper::is_known(const RobotEvent& event) const {
  const auto known = robots_.find(event.robot);
  if (known == robots_.end() || event.restarted) return false;
  const RobotEvent& before = known->second.declared;
  return before.barcode == event.barcode && before.laser.robot_from_laser == event.laser.robot_from_laser &&
         before.laser.range_min_m == event.laser.range_min_m &&
         before.laser.range_max_m == event.laser.range_max_m;
}

void FeatureMapper::take(const RobotEvent& event) {
  if (is_known(event)) return;
  FeatureRobot& robot = robots_[event.robot];
  const bool begins_anew = event.restarted && robot.journey >= 0;
  if (begins_anew) take_waiting(robot, 0, true);
  record({MapInputKind::declared,
          -1,
          event.robot,
          {},
          event.utime,
          std::make_shared<Event>(Event{event.utime, event}),
          {},
          0});
  if (begins_anew) robot.odometry.clear();
}

void FeatureMapper::declare(const RobotEvent& event) {
  FeatureRobot& robot = robots_[event.robot];
  robot.declared = event;
  if (event.barcode >= 0) wearers_[event.barcode] = event.robot;
  if (event.restarted) robot.journey = -1;
}

void FeatureMapper::take(const OdometryEvent& event) {
  const auto robot = robots_.find(event.robot);
  if (robot == robots_.end()) return count_dropped("unknown_robot");
  if (!is_finite(event.odom_from_robot)) return count_dropped("not_finite");
  robot->second.odometry.add(event.utime, event.odom_from_robot);
  if (robot->second.journey < 0)
    record({MapInputKind::begun, -1, event.robot, event.odom_from_robot, event.utime, {}, {}, 0});
  if (robot->second.declared.laser.range_max_m > 0) return;
  constexpr double row_every_s = 0.1;  // without scans: as often as they would come
  const std::vector<JourneyRow>& rows = journey(robot->second).rows;
  if (!rows.empty() && seconds_between(rows.back().utime, event.utime) < row_every_s) return;
  record({MapInputKind::moved, -1, event.robot, event.odom_from_robot, event.utime, {}, {}, 0});
}

void FeatureMapper::wait(const std::string& name, const Event& event) {
  const bool is_scan = std::holds_alternative<ScanEvent>(event.body);
  counts_.scans += is_scan ? 1 : 0;
  const auto robot = robots_.find(name);
  if (robot == robots_.end()) return count_dropped("unknown_robot");
  constexpr std::size_t max_waiting = 1000;
  if (robot->second.waiting.size() >= max_waiting) return count_dropped("no_odometry");
  robot->second.waiting.push_back(event);
}

void FeatureMapper::take_waiting(FeatureRobot& robot, std::int64_t now_utime, bool all) {
  while (!robot.waiting.empty()) {
    const Event event = robot.waiting.front();
    std::optional<Pose> placed = robot.odometry.at(stamp_of(event));
    const bool late = all || seconds_between(event.receive_utime, now_utime) > options_.wait_s;
    if (!placed && !late) return;
    robot.waiting.pop_front();
    if (!placed) placed = robot.odometry.newest();
    if (placed)
      take_placed(robot, event, *placed);
    else
      count_dropped("no_odometry");
  }
}

void FeatureMapper::take_placed(FeatureRobot& robot, const Event& event, const Pose& odom_from_robot) {
  MapInput input{MapInputKind::scanned,
                 -1,
                 robot.declared.robot,
                 odom_from_robot,
                 stamp_of(event),
                 std::make_shared<Event>(event),
                 {},
                 0};
  const auto* sighting = std::get_if<SightingEvent>(&event.body);
  if (sighting == nullptr) {
    const std::int64_t used = counts_.scans_used;
    input.number = next_scan_;
    apply(input);
    if (counts_.scans_used == used) {  // nothing of it is needed any more
      input.kind = MapInputKind::moved;
      input.number = -1;
      input.event.reset();
    }
    return inputs_.push_back(std::move(input));
  }
  input.number = next_number_;
  input.kind = MapInputKind::sighted;
  if (const auto wearer = wearers_.find(sighting->barcode); wearer != wearers_.end()) {
    const OdometryTrack& odometry = robots_.at(wearer->second).odometry;
    input.odom_from_target = odometry.at(sighting->utime);
    if (!input.odom_from_target && !odometry.empty()) {
      input.odom_from_target = odometry.newest();
      input.target_late_s = std::abs(seconds_between(odometry.newest_utime(), sighting->utime));
    }
  }
  record(std::move(input));
}

void FeatureMapper::apply(const MapInput& input) {
  std::int32_t& next = input.kind == MapInputKind::scanned ? next_scan_ : next_number_;
  next = std::max(next, input.number + 1);
  if (input.kind == MapInputKind::declared) return declare(std::get<RobotEvent>(input.event->body));
  if (input.kind == MapInputKind::tag) {
    tags_.insert(std::get<TagEvent>(input.event->body).barcode);
    return;
  }
  FeatureRobot& robot = robots_[input.robot];
  if (input.kind == MapInputKind::begun) {
    if (robot.journey < 0) begin_journey(robot, input.odom_from_robot);
    return;
  }
  if (robot.journey < 0) begin_journey(robot, input.odom_from_robot);
  note_way(robot, input.odom_from_robot);
  const bool by_scans = options_.kind == FeatureMapKind::segments && robot.declared.laser.range_max_m > 0;
  if (!by_scans || input.kind == MapInputKind::sighted) move_by_odometry(robot);
  robot.last_utime = std::max(robot.last_utime, input.utime);
  if (input.kind == MapInputKind::sighted) {
    const auto& sighting = std::get<SightingEvent>(input.event->body);
    sightings_.push_back({sighting, false, "", -1});
    const std::string reason = use(robot, input);
    FeatureSighting& row = sightings_[sightings_.size() - 1];
    if (reason != "waits") {
      row.used = reason.empty();
      row.reason = reason;
    }
    tell(sightings_.size() - 1);
    return;
  }
  const bool is_new_place = input.kind == MapInputKind::scanned &&
                            observe(robot, std::get<ScanEvent>(input.event->body).scan, input.utime);
  add_row(robot, input.utime);
  if (!is_new_place) return;
  take_up_meetings(journey(robot).team);
  lay_over_others(journey(robot).team, input);
}

void FeatureMapper::continue_from(FeatureMapper& other) {
  for (auto& [name, robot] : other.robots_) {
    robots_[name].odometry = std::move(robot.odometry);
    robots_[name].waiting = std::move(robot.waiting);
  }
  counts_.events = other.counts_.events;
  counts_.scans = other.counts_.scans;
  counts_.withdrawn = other.counts_.withdrawn;
  counts_.dropped = other.counts_.dropped;
  counts_.first_receive_utime = other.counts_.first_receive_utime;
  counts_.last_receive_utime = other.counts_.last_receive_utime;
  next_number_ = other.next_number_;
  next_scan_ = other.next_scan_;
}

}  // namespace isthmus
