#include "server/feature_maps/feature_mapper.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "relations/chi_squared.hpp"
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

bool is_complete(const SightingEvent& s) {
  return s.range_m > 0 && std::isfinite(s.range_m) && std::isfinite(s.bearing_rad) && s.range_sigma_m > 0 &&
         s.bearing_sigma_rad > 0 && std::isfinite(s.range_sigma_m) && std::isfinite(s.bearing_sigma_rad);
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
  if (kind == FeatureMapKind::points) options.stamp_share = 0;  // velocities are integrated, not measured
  options.odometry_noise.first_scale = kind == FeatureMapKind::segments ? 2 : 3;
  return options;
}

FeatureMapper::FeatureMapper(const FeatureMapOptions& options)
    : options_(options), gate_(chi2_quantile(options.sighting_probability, 2)) {}

void FeatureMapper::handle(const Event& event) {
  if (counts_.events++ == 0) counts_.first_receive_utime = event.receive_utime;
  counts_.last_receive_utime = std::max(counts_.last_receive_utime, event.receive_utime);
  if (const auto* robot = std::get_if<RobotEvent>(&event.body)) take(*robot);
  if (const auto* tag = std::get_if<TagEvent>(&event.body)) tags_.insert(tag->barcode);
  if (const auto* odometry = std::get_if<OdometryEvent>(&event.body)) take(*odometry);
  if (const auto* scan = std::get_if<ScanEvent>(&event.body)) wait(scan->robot, event);
  if (const auto* sighting = std::get_if<SightingEvent>(&event.body)) wait(sighting->robot, event);
  for (auto& [name, robot] : robots_) take_waiting(robot, event.receive_utime, false);
}

void FeatureMapper::finish() {
  for (auto& [name, robot] : robots_) take_waiting(robot, 0, true);
}

void FeatureMapper::take(const RobotEvent& event) {
  FeatureRobot& robot = robots_[event.robot];
  const bool begins_anew = event.restarted && robot.journey >= 0;
  robot.declared = event;
  if (event.barcode >= 0) wearers_[event.barcode] = event.robot;
  if (!begins_anew) return;
  take_waiting(robot, 0, true);
  robot.journey = -1;
  robot.odometry.clear();
}

void FeatureMapper::take(const OdometryEvent& event) {
  const auto robot = robots_.find(event.robot);
  if (robot == robots_.end()) return count_dropped("unknown_robot");
  if (!is_finite(event.odom_from_robot)) return count_dropped("not_finite");
  robot->second.odometry.add(event.utime, event.odom_from_robot);
  if (robot->second.journey < 0) begin_journey(robot->second, event.odom_from_robot);
  if (robot->second.declared.laser.range_max_m > 0) return;
  constexpr double row_every_s = 0.1;  // without scans: as often as they would come
  const std::vector<JourneyRow>& rows = journey(robot->second).rows;
  if (!rows.empty() && seconds_between(rows.back().utime, event.utime) < row_every_s) return;
  move_to(robot->second, event.odom_from_robot);
  add_row(robot->second, event.utime);
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
  move_to(robot, odom_from_robot);
  if (const auto* scan = std::get_if<ScanEvent>(&event.body)) {
    observe(robot, scan->scan);
    return add_row(robot, scan->scan.utime);
  }
  const auto& sighting = std::get<SightingEvent>(event.body);
  const std::string reason = is_complete(sighting) ? use(robot, sighting) : "incomplete";
  sightings_.push_back({sighting, reason.empty(), reason});
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
  const std::vector<int> gone =
      filter.contradict(own.member, outcome, FreeInScan(scan, robot.declared.laser));
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
}

std::string FeatureMapper::use(FeatureRobot& robot, const SightingEvent& sighting) {
  std::int64_t& last = last_used_.try_emplace({sighting.robot, sighting.barcode}, 0).first->second;
  if (last != 0 && std::abs(seconds_between(last, sighting.utime)) < options_.repeat_s) return "repeated";
  last = sighting.utime;
  if (tags_.contains(sighting.barcode)) return use_landmark(robot, sighting);
  const auto wearer = wearers_.find(sighting.barcode);
  if (wearer == wearers_.end() || wearer->second == sighting.robot) return "unknown_barcode";
  const FeatureRobot& target = robots_.at(wearer->second);
  if (target.journey < 0) return "target_not_on_map";
  return use_robot(robot, sighting, target);
}

std::string FeatureMapper::use_landmark(const FeatureRobot& robot, const SightingEvent& sighting) {
  if (options_.kind != FeatureMapKind::points) return "tags_are_not_used";
  Journey& own = journey(robot);
  Team& team = team_of(own);
  const ObservedFeature seen = point_seen(sighting);
  const auto known = team.landmarks.find(sighting.barcode);
  const int id = known == team.landmarks.end() ? -1 : known->second;
  if (const auto index = index_of(team.filter.state(), id)) {
    const auto measured = measure_feature(team.filter.state(), *index, own.member, seen);
    if (!measured || squared_distance(team.filter.state().covariance, *measured) > gate_)
      return "contradicts_map";
  }
  const std::vector<int> used = team.filter.observe_known(own.member, {&seen, 1}, {&id, 1});
  if (used.front() < 0) return "not_used";
  team.landmarks[sighting.barcode] = used.front();
  join_by_landmarks();
  return "";
}

std::string FeatureMapper::use_robot(const FeatureRobot& robot, const SightingEvent& sighting,
                                     const FeatureRobot& target) {
  const Journey& own = journey(robot);
  const Journey& other = journey(target);
  if (own.team == other.team) {
    FeatureFilter& filter = team_of(own).filter;
    const RelativeSighting seen{own.member,           other.member,           sighting.range_m,
                                sighting.bearing_rad, sighting.range_sigma_m, sighting.bearing_sigma_rad};
    const auto measured = measure_robot(filter.state(), seen);
    if (!measured || squared_distance(filter.state().covariance, *measured) > gate_) return "contradicts_map";
    return filter.observe_robot(seen) ? "" : "not_used";
  }
  if (options_.kind == FeatureMapKind::points) return "maps_share_no_landmarks";
  one_way_[{sighting.robot, target.declared.robot}] = sighting;
  const auto back = one_way_.find({target.declared.robot, sighting.robot});
  if (back == one_way_.end() ||
      std::abs(seconds_between(back->second.utime, sighting.utime)) > options_.mutual_s)
    return "waits_for_the_other";
  const Meeting meeting{back->second, sighting, target.journey, robot.journey};
  one_way_.erase(back);  // each sighting serves one meeting
  one_way_.erase({sighting.robot, target.declared.robot});
  return meet(meeting);
}

std::string FeatureMapper::meet(const Meeting& meeting) {
  MutualSighting mutual;
  mutual.range_1_m = meeting.first.range_m;
  mutual.range_2_m = meeting.second.range_m;
  mutual.bearing_1_rad = meeting.first.bearing_rad;
  mutual.bearing_2_rad = meeting.second.bearing_rad;
  mutual.range_1_sigma_m = meeting.first.range_sigma_m;
  mutual.range_2_sigma_m = meeting.second.range_sigma_m;
  mutual.bearing_1_sigma_rad = meeting.first.bearing_sigma_rad;
  mutual.bearing_2_sigma_rad = meeting.second.bearing_sigma_rad;
  // Robots that drive between the two sightings are up to half a metre a second elsewhere.
  const double moved_m = 0.5 * std::abs(seconds_between(meeting.first.utime, meeting.second.utime));
  for (double* sigma : {&mutual.range_1_sigma_m, &mutual.range_2_sigma_m})
    *sigma = std::hypot(*sigma, moved_m);
  for (double* sigma : {&mutual.bearing_1_sigma_rad, &mutual.bearing_2_sigma_rad})
    *sigma = std::hypot(*sigma, moved_m / mutual.range_1_m);
  const double apart = std::abs(mutual.range_1_m - mutual.range_2_m);
  if (apart * apart > gate_ * (std::pow(mutual.range_1_sigma_m, 2) + std::pow(mutual.range_2_sigma_m, 2)))
    return "disagrees_with_the_other";
  const RobotAlignment alignment = align_robots(mutual);
  const Journey one = journeys_[static_cast<std::size_t>(meeting.journey_1)];
  const Journey two = journeys_[static_cast<std::size_t>(meeting.journey_2)];
  const JoinedTeams joined =
      joined_at_meeting(team_of(one), one.member, team_of(two), two.member, alignment, options_.fusion);
  if (joined.duplicates < options_.min_duplicates && !borne_out(meeting, alignment)) {
    ++counts_.fusions_waiting;
    return "waits_for_another_meeting";
  }
  join(one.team, two.team, joined);
  return "";
}

bool FeatureMapper::borne_out(const Meeting& meeting, const RobotAlignment& alignment) {
  const Journey& one = journeys_[static_cast<std::size_t>(meeting.journey_1)];
  const Journey& two = journeys_[static_cast<std::size_t>(meeting.journey_2)];
  const auto pose = [&](const Journey& own) {
    return team_of(own).filter.state().robots[static_cast<std::size_t>(own.member)].map_from_robot;
  };
  const Pose first = pose(one), second = pose(two);
  const Pose maps = first * alignment.one_from_two * inverse(second);
  const double heading_sigma = std::sqrt(alignment.covariance(2, 2));
  const bool agrees = std::any_of(pending_.begin(), pending_.end(), [&](const Pending& other) {
    if (other.team_1 != one.team || other.team_2 != two.team) return false;
    const Pose there = other.one_from_two * second, here = maps * second;
    const double off_m = std::hypot(there.x - here.x, there.y - here.y);
    const double turned = std::abs(wrap_angle(there.yaw - here.yaw));
    const double both = std::hypot(heading_sigma, other.heading_sigma_rad);
    const double k = options_.agree_sigmas;
    return turned < k * both && off_m < k * (other.range_sigma_m + options_.agree_reach_m * both);
  });
  pending_.push_back({one.team, two.team, maps, heading_sigma, std::sqrt(alignment.covariance(0, 0))});
  return agrees;
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
  for (const auto& [barcode, id] : gone.landmarks) kept.landmarks.try_emplace(barcode, id + ids);
  for (const int number : gone.journeys) {
    Journey& moved = journeys_[static_cast<std::size_t>(number)];
    moved.team = one;
    moved.member = static_cast<int>(kept.journeys.size());
    for (JourneyRow& row : moved.rows) row.map_from_robot = joined.one_from_two * row.map_from_robot;
    kept.journeys.push_back(number);
  }
  kept.filter.state() = joined.state;
  gone.journeys.clear();
  ++counts_.fusions;
}

FeatureMaps FeatureMapper::maps() const {
  FeatureMaps maps{options_.kind, {}, journeys_, sightings_, counts_};
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
