#include "server/feature_maps/feature_mapper.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "relations/chi_squared.hpp"
#include "server/feature_maps/feature_record.hpp"
#include "server/features/measurement.hpp"

namespace isthmus {
namespace {

double seconds_between(std::int64_t from_utime, std::int64_t to_utime) {
  return 1e-6 * (static_cast<double>(to_utime) - static_cast<double>(from_utime));
}

std::int64_t stamp_of(const Event& event) {
  if (const auto* scan = std::get_if<ScanEvent>(&event.body)) return scan->scan.utime;
  return std::get<SightingEvent>(event.body).utime;
}

/// Of a σ: infinity is what was not measured.
bool is_right(double value, double sigma) { return std::isinf(sigma) || std::isfinite(value); }

/// Whether there is a range, a bearing or both, as sound numbers.
bool is_usable(const SightingEvent& s) {
  const bool range = std::isfinite(s.range_sigma_m), bearing = std::isfinite(s.bearing_sigma_rad);
  return s.range_sigma_m > 0 && s.bearing_sigma_rad > 0 && (range || bearing) &&
         is_right(s.range_m, s.range_sigma_m) && is_right(s.bearing_rad, s.bearing_sigma_rad) &&
         (!range || s.range_m > 0);
}

bool is_whole(const SightingEvent& s) {
  return std::isfinite(s.range_sigma_m) && std::isfinite(s.bearing_sigma_rad);
}

/// The landmark in the robot's frame.
ObservedFeature point_seen(const SightingEvent& s) {
  const Eigen::Vector2d ray(std::cos(s.bearing_rad), std::sin(s.bearing_rad)), side(-ray.y(), ray.x());
  const double across = s.range_m * s.bearing_sigma_rad;
  return {point_feature(s.range_m * ray), s.range_sigma_m * s.range_sigma_m * ray * ray.transpose() +
                                              across * across * side * side.transpose()};
}

/// Whether a point of the robot's frame lies well within what the scan saw free.
class FreeInScan {
 public:
  FreeInScan(const Scan& scan, const Laser& laser)
      : scan_(scan), laser_(laser), laser_from_robot_(inverse(laser.robot_from_laser)) {}

  bool operator()(const Eigen::Vector2d& point) const {
    constexpr double margin_m = 0.3;
    const Eigen::Vector2d seen = laser_from_robot_ * point;
    const double bearing = std::atan2(seen.y(), seen.x()) - scan_.bearing0_rad;
    const double beam = std::round(wrap_angle(bearing) / scan_.bearing_step_rad);
    for (const double turn : {0.0, 2 * std::numbers::pi / std::abs(scan_.bearing_step_rad)}) {
      const double index = beam + turn;
      if (index < 0 || index >= static_cast<double>(scan_.ranges_m.size())) continue;
      const float range = scan_.ranges_m[static_cast<std::size_t>(index)];
      return classify(range, laser_) == BeamKind::hit && seen.norm() + margin_m < range;
    }
    return false;
  }

 private:
  const Scan& scan_;
  const Laser& laser_;
  Pose laser_from_robot_;
};

}  // namespace

FeatureMapOptions feature_map_options(FeatureMapKind kind) {
  FeatureMapOptions options;
  options.kind = kind;
  options.filter.association.probability = 0.999;
  options.filter.max_features = 1000;
  options.scan_features.noise.surface_sigma_m = 0.02;
  options.scan_features.segmentation.min_length_m = 1;
  options.fusion.points = false;                                // barcodes
  if (kind == FeatureMapKind::points) options.stamp_share = 0;  // velocities are integrated, not measured
  options.odometry_noise.first_scale = kind == FeatureMapKind::segments ? 2 : 3;
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
    apply(input);
    if (counts_.scans_used == used) {  // nothing of it is needed any more
      input.kind = MapInputKind::moved;
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
  next_number_ = std::max(next_number_, input.number + 1);
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
  move_to(robot, input.odom_from_robot);
  robot.last_utime = std::max(robot.last_utime, input.utime);
  if (input.kind == MapInputKind::sighted) {
    const auto& sighting = std::get<SightingEvent>(input.event->body);
    sightings_.push_back({sighting, false, "", -1});
    const std::string reason = is_usable(sighting) ? use(robot, input) : "incomplete";
    FeatureSighting& row = sightings_[sightings_.size() - 1];
    if (reason != "waits") {
      row.used = reason.empty();
      row.reason = reason;
    }
    tell(sightings_.size() - 1);
    return;
  }
  if (input.kind == MapInputKind::scanned) observe(robot, std::get<ScanEvent>(input.event->body).scan);
  add_row(robot, input.utime);
}

void FeatureMapper::tell(std::size_t sighting) {
  const SightingRecord record = record_of(sightings_[sighting]);
  if (sighting == told_.size())
    told_.append(record);
  else
    told_.set_verdict(sighting, record.verdict, record.reason, record.closure);
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
}

void FeatureMapper::begin_journey(FeatureRobot& robot, const Pose& odom_from_robot) {
  Team team{FeatureFilter(options_.filter), {static_cast<int>(journeys_.size())}, {}};
  team.filter.add_robot({}, Eigen::Matrix3d::Zero());
  robot.journey = static_cast<int>(journeys_.size());
  robot.odom_from_last = odom_from_robot;
  robot.noise = OdometryNoise(options_.odometry_noise);
  robot.way_m = options_.observe_every_m;  // its first scan is used
  journeys_.push_back({robot.declared.robot, static_cast<int>(teams_.size()), 0, {}});
  teams_.push_back(std::move(team));
}

void FeatureMapper::move_to(FeatureRobot& robot, const Pose& odom_from_robot) {
  if (robot.journey < 0) return begin_journey(robot, odom_from_robot);
  const Pose step = ominus(odom_from_robot, robot.odom_from_last);
  robot.odom_from_last = odom_from_robot;
  if (step == Pose{}) return;
  const Journey& own = journey(robot);
  Eigen::Matrix3d covariance = robot.noise.covariance(step, options_.odometry_noise);
  covariance.diagonal() += (options_.stamp_share * wrapped_difference(step, robot.last_step)).cwiseAbs2();
  team_of(own).filter.move(own.member, step, covariance);
  robot.last_step = step;
  robot.way_m += std::hypot(step.x, step.y);
  robot.turn_rad += std::abs(step.yaw);
}

void FeatureMapper::observe(FeatureRobot& robot, const Scan& scan) {
  if (options_.kind != FeatureMapKind::segments) return;
  if (robot.way_m < options_.observe_every_m && robot.turn_rad < options_.observe_every_rad) return;
  robot.way_m = robot.turn_rad = 0;
  std::vector<ObservedFeature> seen;
  for (const ScanSegment& segment :
       find_features(scan, robot.declared.laser, options_.scan_features).segments)
    seen.push_back(segment.observed);
  const Journey& own = journey(robot);
  FeatureFilter& filter = team_of(own).filter;
  const FeatureScanOutcome outcome = observe_or_slip(filter, own.member, seen);
  FeatureScanOutcome still_there = outcome;  // a laser sees no barcode, and past one that hangs in the open
  for (const auto& [barcode, id] : team_of(own).landmarks) still_there.paired.push_back({0, id});
  const std::vector<int> gone =
      filter.contradict(own.member, still_there, FreeInScan(scan, robot.declared.laser));
  robot.matched = !outcome.paired.empty();
  ++counts_.scans_used;
  counts_.segments_seen += static_cast<std::int64_t>(seen.size());
  counts_.segments_paired += static_cast<std::int64_t>(outcome.paired.size());
  counts_.contradicted += static_cast<std::int64_t>(gone.size());
}

FeatureScanOutcome FeatureMapper::observe_or_slip(FeatureFilter& filter, int member,
                                                  std::span<const ObservedFeature> seen) {
  const FeatureFilter before = filter;
  FeatureScanOutcome best = filter.observe(member, seen);
  if (static_cast<double>(best.paired.size()) >= options_.slip_share * static_cast<double>(seen.size()))
    return best;
  const Eigen::Vector3d sigma(0.5 * options_.slip_m, 0.5 * options_.slip_m, 0.5 * options_.slip_rad);
  bool is_slip = false;
  std::size_t enough = std::max(options_.min_slipped, best.paired.size() + options_.slip_gain);
  for (const double yaw : {0.0, -1.0, 1.0, -2.0, 2.0}) {
    for (const double x : {0.0, -1.0, 1.0}) {
      for (const double y : {0.0, -1.0, 1.0}) {
        FeatureFilter slipped = before;
        slipped.move(member, {options_.slip_m * x, options_.slip_m * y, options_.slip_rad * yaw},
                     sigma.cwiseAbs2().asDiagonal());
        FeatureScanOutcome outcome = slipped.observe(member, seen);
        if (outcome.paired.size() < enough) continue;
        enough = outcome.paired.size() + 1;
        is_slip = true;
        best = std::move(outcome);
        filter = std::move(slipped);
      }
    }
  }
  if (is_slip) ++counts_.slips;
  return best;
}

void FeatureMapper::add_row(const FeatureRobot& robot, std::int64_t utime) {
  Journey& own = journeys_[static_cast<std::size_t>(robot.journey)];
  const FeatureState& state = team_of(own).filter.state();
  own.rows.push_back({utime, state.robots[static_cast<std::size_t>(own.member)].map_from_robot});
  moved_.insert(own.robot);
}

std::string FeatureMapper::use(FeatureRobot& robot, const MapInput& input) {
  const auto& sighting = std::get<SightingEvent>(input.event->body);
  std::int64_t& last = last_used_[{sighting.robot, sighting.barcode}];
  if (last != 0 && std::abs(seconds_between(last, sighting.utime)) < options_.repeat_s) return "repeated";
  last = sighting.utime;
  const auto wearer = wearers_.find(sighting.barcode);
  const bool is_tag = tags_.contains(sighting.barcode) || (options_.any_tag && wearer == wearers_.end());
  if (is_tag) return use_landmark(robot, input);
  if (wearer == wearers_.end() || wearer->second == sighting.robot) return "unknown_barcode";
  FeatureRobot& target = robots_.at(wearer->second);
  if (target.journey < 0) return "target_not_on_map";
  const std::int64_t known_utime = input.utime - static_cast<std::int64_t>(1e6 * input.target_late_s);
  if (input.odom_from_target && known_utime > target.last_utime) {
    move_to(target, *input.odom_from_target);
    target.last_utime = known_utime;
  }
  return use_robot(robot, input, target);
}

std::string FeatureMapper::use_landmark(const FeatureRobot& robot, const MapInput& input) {
  const auto& sighting = std::get<SightingEvent>(input.event->body);
  Journey& own = journey(robot);
  Team& team = team_of(own);
  const auto known = team.landmarks.find(sighting.barcode);
  const int id = known == team.landmarks.end() ? -1 : known->second;
  const auto index = index_of(team.filter.state(), id);
  if (index) {
    const RelativeSighting seen{own.member,
                                0,
                                sighting.range_m,
                                sighting.bearing_rad,
                                sighting.range_sigma_m,
                                sighting.bearing_sigma_rad};
    const auto measured =  // as it will be used
        is_whole(sighting) ? measure_feature(team.filter.state(), *index, own.member, point_seen(sighting))
                           : measure_point(team.filter.state(), *index, seen);
    const double gate = chi2_quantile(options_.sighting_probability, is_whole(sighting) ? 2 : 1);
    if (!measured || squared_distance(team.filter.state().covariance, *measured) > gate)
      return "contradicts_map";
    if (!is_whole(sighting)) return team.filter.correct_by(*measured) ? "" : "not_used";
  }
  if (!is_whole(sighting)) return "place_not_known";
  const ObservedFeature seen = point_seen(sighting);
  const std::vector<int> used = team.filter.observe_known(own.member, {&seen, 1}, {&id, 1});
  if (used.front() < 0) return "not_used";
  team.landmarks[sighting.barcode] = used.front();
  first_seen_.try_emplace({robot.journey, sighting.barcode}, input.number);
  if (options_.kind == FeatureMapKind::points) {
    join_by_landmarks();
  } else {
    for (int other = 0; other < static_cast<int>(teams_.size()); ++other)
      if (other != own.team && teams_[static_cast<std::size_t>(other)].landmarks.contains(sighting.barcode))
        consider(std::min(own.team, other), std::max(own.team, other));
  }
  return "";
}

std::string FeatureMapper::use_robot(const FeatureRobot& robot, const MapInput& input,
                                     const FeatureRobot& target) {
  const auto& sighting = std::get<SightingEvent>(input.event->body);
  if (journey(robot).team == journey(target).team)
    return use_on_one_map(sighting, robot.journey, target.journey);
  if (options_.kind == FeatureMapKind::points) return "maps_share_no_landmarks";
  return hear(input, robot.journey, target.journey, target);
}

std::string FeatureMapper::use_on_one_map(const SightingEvent& sighting, int observer, int target) {
  const Journey& own = journeys_[static_cast<std::size_t>(observer)];
  const Journey& other = journeys_[static_cast<std::size_t>(target)];
  FeatureFilter& filter = team_of(own).filter;
  const RelativeSighting seen{own.member,           other.member,           sighting.range_m,
                              sighting.bearing_rad, sighting.range_sigma_m, sighting.bearing_sigma_rad};
  const auto measured = measure_robot(filter.state(), seen);
  if (!measured) return "not_used";
  judge_fusion(observer, target, *measured, sighting);
  const double gate =
      chi2_quantile(options_.sighting_probability, static_cast<int>(measured->residual.size()));
  if (squared_distance(filter.state().covariance, *measured) > gate) return "contradicts_map";
  return filter.observe_robot(seen) ? "" : "not_used";
}

void FeatureMapper::join_by_landmarks() {
  for (std::size_t a = 0; a < teams_.size(); ++a) {
    for (std::size_t b = a + 1; b < teams_.size(); ++b) {
      if (teams_[a].journeys.empty() || teams_[b].journeys.empty()) continue;
      const auto joined =
          joined_by_landmarks(teams_[a], teams_[b], options_.min_landmarks, options_.sighting_probability);
      if (joined) join(static_cast<int>(a), static_cast<int>(b), *joined);
    }
  }
}

void FeatureMapper::join(int one, int two, const JoinedTeams& joined) {
  Team& kept = teams_[static_cast<std::size_t>(one)];
  Team& gone = teams_[static_cast<std::size_t>(two)];
  const int ids = kept.filter.state().next_id;
  FeatureState state = joined.state;
  for (const auto& [barcode, id] : gone.landmarks) {
    if (kept.landmarks.try_emplace(barcode, id + ids).second) continue;
    if (const auto twin = index_of(state, id + ids)) remove_feature(state, *twin);
  }
  for (const int number : gone.journeys) {
    Journey& moved = journeys_[static_cast<std::size_t>(number)];
    moved.team = one;
    moved.member = static_cast<int>(kept.journeys.size());
    for (JourneyRow& row : moved.rows) row.map_from_robot = joined.one_from_two * row.map_from_robot;
    for (Heard& heard : heard_) {  // with other maps
      if (heard.observer == number) heard.clue.observer = joined.one_from_two * heard.clue.observer;
      if (heard.target == number) heard.clue.target = joined.one_from_two * heard.clue.target;
    }
    kept.journeys.push_back(number);
  }
  kept.filter.state() = std::move(state);
  gone.journeys.clear();
  gone.landmarks.clear();
  ++counts_.fusions;
}

FeatureMaps FeatureMapper::maps() const {
  FeatureMaps maps{options_.kind, {}, journeys_, sightings_, {}, counts_};
  for (const auto& [id, fusion] : fusions_) maps.fusions.push_back(fusion);
  std::vector<int> order;
  for (std::size_t i = 0; i < teams_.size(); ++i)
    if (!teams_[i].journeys.empty()) order.push_back(static_cast<int>(i));
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return teams_[static_cast<std::size_t>(a)].filter.state().features.size() >
           teams_[static_cast<std::size_t>(b)].filter.state().features.size();
  });
  for (const int i : order) {
    for (const int number : teams_[static_cast<std::size_t>(i)].journeys)
      maps.journeys[static_cast<std::size_t>(number)].team = static_cast<int>(maps.teams.size());
    maps.teams.push_back(teams_[static_cast<std::size_t>(i)]);
  }
  return maps;
}

}  // namespace isthmus
