#include "server/engine/frozen/frozen.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/engine/frozen/sighted_pose.hpp"
#include "server/engine/localise/follow.hpp"

namespace isthmus {
namespace {

constexpr std::size_t max_unplaced = 10'000;

double way_since_match_m(const Localisation& place) {
  const Pose& path = place.since_last_patch.start_from_end;
  return std::hypot(path.x, path.y);
}

bool is_in_doubt(const Localisation& place, const FrozenOptions& options) {
  const double variance = place.since_last_patch.covariance.topLeftCorner<2, 2>().trace();
  return place.suspect || way_since_match_m(place) > options.doubted_m ||
         variance > options.common.known_sigma_m * options.common.known_sigma_m;
}

// A place that is a guess, until a scan fits it well.
Localisation guessed(const ManifoldPose& pose, const Pose& odom_from_robot, std::int64_t utime,
                     const FrozenOptions& options) {
  Localisation place;
  place.pose = pose;
  place.covariance = place.tracking_covariance =
      Eigen::Vector3d(options.common.known_sigma_m, options.common.known_sigma_m,
                      options.common.yaw_rad(options.common.known_sigma_m))
          .cwiseAbs2()
          .asDiagonal();
  place.odom_from_robot = odom_from_robot;
  place.utime = utime;
  place.last_patch = pose.patch;
  place.suspect = true;
  return place;
}

}  // namespace

std::optional<ScanOutcome> Frozen::take_scan(const Map& map, Robot& robot, Observation observation,
                                             const Pose& odom_from_robot, const EngineOptions& options) {
  const std::string& name = robot.declaration.robot;
  const std::int64_t utime = observation.scan.utime;
  if (const auto given = given_.find(name); given != given_.end()) {
    if (auto done = try_given(map, robot, given->second, observation, odom_from_robot, options)) return done;
    const bool is_old = utime > given->second.utime + options.frozen.given_told_us;
    if (!given->second.trial && is_old) given_.erase(given);
  }
  if (!robot.place || robot.place->suspect)
    put_where_thought(robot, lookouts_[name], utime, odom_from_robot, options.frozen);
  if (robot.place) {
    if (auto done = follow_on(map, robot, observation, odom_from_robot, options)) return done;
  }
  Finder& finder = lookouts_[name].finder;
  finder.take_scan(robot, std::move(observation), odom_from_robot, options);
  // Where it was before it was carried away, nobody can tell from where it is found.
  if (!robot.unplaced.empty() && robot.unplaced.front().utime < finder.since_utime())
    std::erase_if(robot.unplaced,
                  [&](const UnplacedScan& unplaced) { return unplaced.utime < finder.since_utime(); });
  robot.unplaced.push_back({utime, odom_from_robot});
  if (robot.unplaced.size() > max_unplaced) robot.unplaced.erase(robot.unplaced.begin());
  return std::nullopt;
}

DropReason Frozen::take_given(const Map& map, const Robot& robot, const InitialPoseEvent& event,
                              const FrozenOptions& options) {
  const GivenPoseReading reading = read_given_pose(event, map);
  if (!reading.pose) return reading.refusal;
  Given& given = given_[robot.declaration.robot];
  given = {};
  given.trial = GivenPose{*reading.pose,   {},           event.sigma_m,
                          event.sigma_rad, std::nullopt, options.common.max_lost_scans};
  return DropReason::none;
}

bool Frozen::take_sighting(const Map& map, const std::map<std::string, Robot>& robots,
                           const SightingEvent& event, const std::string& target, bool is_tag,
                           const FrozenOptions& options) {
  const Robot& observer = robots.at(event.robot);
  const auto seen = robots.find(target);
  std::optional<GivenPose> trial;
  std::string lost = event.robot;
  if (is_tag && !is_found(observer)) {
    trial = where_it_sees(event, place_of_tag(map, event.barcode), map, options);
  } else if (!is_tag && is_found(observer) && !is_found(seen->second)) {
    lost = target;
    trial = where_it_is_seen(event, place_at(observer, event.utime), map, options);
  } else if (!is_tag && !is_found(observer) && is_found(seen->second)) {
    trial = where_it_sees(event, place_at(seen->second, event.utime), map, options);
  }
  if (!trial) return false;
  Given& given = given_[lost];
  // What operators say has its turn first, and a search that was in vain is not begun again at once.
  if (given.trial || event.utime < given.sighted_utime + options.sighting_every_us) return false;
  trial->odom_from_robot = robots.at(lost).odometry.at(event.utime);
  trial->tries_left = options.common.max_lost_scans;
  given = {};
  given.trial = std::move(trial);
  given.sighted_utime = event.utime;
  given.by_sighting = true;
  return true;
}

std::optional<ScanOutcome> Frozen::try_given(const Map& map, Robot& robot, Given& given,
                                             const Observation& observation, const Pose& odom_from_robot,
                                             const EngineOptions& options) {
  if (!given.trial) return std::nullopt;
  GivenPose& trial = *given.trial;
  if (trial.odom_from_robot) trial.move(ominus(odom_from_robot, *trial.odom_from_robot));
  trial.odom_from_robot = odom_from_robot;
  const std::int64_t utime = given.utime = observation.scan.utime;
  if (const auto found = search_about(trial, map, observation.points, options, given.why)) {
    Robot tried = robot;
    tried.place = guessed(*found, odom_from_robot, utime, options.frozen);
    Expectation expectation = expect(tried, odom_from_robot, utime, options);
    expectation.sought = true;
    choose_local_map(map, tried, expectation.local_from_robot, observation.points, options);
    const Placement placement = localise(tried, expectation, tried.local_map, observation.points, options);
    if (placement.matched) {
      follow(map, tried, expectation, placement, odom_from_robot, utime, options);
      tried.place->since_last_patch = {};
      robot = std::move(tried);
      lookouts_.erase(robot.declaration.robot);
      given_.erase(robot.declaration.robot);
      return ScanOutcome{answer(map, robot, true), Unmatched::no, true, false, false};
    }
    given.why = NotFound::given_pose_misfits;
  }
  if (--trial.tries_left <= 0) given.trial.reset();
  return std::nullopt;
}

void Frozen::put_where_thought(Robot& robot, Lookout& lookout, std::int64_t utime,
                               const Pose& odom_from_robot, const FrozenOptions& options) {
  std::optional<ManifoldPose> thought = lookout.finder.take_found();
  const bool sought = thought.has_value();
  if (!sought && lookout.last) thought = lookout.last->pose;
  lookout.last.reset();
  if (!thought) return;
  robot.place = guessed(*thought, odom_from_robot, utime, options);
  lookout.tries_left = options.common.max_lost_scans;
  lookout.moved_away = true;
  lookout.sought = sought;
}

std::optional<ScanOutcome> Frozen::follow_on(const Map& map, Robot& robot, const Observation& observation,
                                             const Pose& odom_from_robot, const EngineOptions& options) {
  const std::vector<ScanPoint>& points = observation.points;
  const std::int64_t utime = observation.scan.utime;
  const std::string& name = robot.declaration.robot;
  const auto lookout = lookouts_.find(name);
  Expectation expectation = expect(robot, odom_from_robot, utime, options);
  expectation.sought = lookout != lookouts_.end() && lookout->second.sought;
  choose_local_map(map, robot, expectation.local_from_robot, points, options);
  const Placement placement = localise(robot, expectation, robot.local_map, points, options);
  follow(map, robot, expectation, placement, odom_from_robot, utime, options);
  if (placement.matched) {
    robot.place->since_last_patch = {};  // since the last match, here: the robot has no patches
    const bool moved_away = lookout != lookouts_.end() && lookout->second.moved_away;
    if (lookout != lookouts_.end()) lookouts_.erase(lookout);
    return ScanOutcome{answer(map, robot, true), Unmatched::no, moved_away || robot.session < 0, false,
                       false};
  }
  robot.place->suspect = is_in_doubt(*robot.place, options.frozen);
  if (!robot.place->suspect)
    return ScanOutcome{answer(map, robot, false), placement.reason, false, false, false};
  lose(robot, lookouts_[name], expectation, options.frozen);
  return std::nullopt;
}

// One more scan that does not fit where the robot was thought to be.
void Frozen::lose(Robot& robot, Lookout& lookout, const Expectation& expectation,
                  const FrozenOptions& options) {
  if (!expectation.plausible && lookout.tries_left == 0) lookout.tries_left = options.common.max_lost_scans;
  const bool tried_enough = lookout.tries_left > 0 && --lookout.tries_left == 0;
  if (!tried_enough && way_since_match_m(*robot.place) <= options.given_up_m) return;
  robot.place.reset();
  lookout.moved_away = true;
}

void Frozen::restart(Robot& robot) {
  Lookout& lookout = lookouts_[robot.declaration.robot];
  lookout = {};
  lookout.last = std::exchange(robot.place, std::nullopt);
  lookout.moved_away = true;
  robot.unplaced.clear();
}

void Frozen::advance(const Map& map, const EngineOptions& options, std::int64_t now_utime) {
  credit_.earn(now_utime, {options.frozen.work_share, options.common.max_credit_us});
  // In turn, so that no robot waits for another to be found.
  const auto next = [&] {
    const auto works = [](const auto& entry) { return entry.second.finder.has_work(); };
    const auto after = lookouts_.upper_bound(searched_last_);
    const auto found = std::find_if(after, lookouts_.end(), works);
    return found != lookouts_.end() ? found : std::find_if(lookouts_.begin(), lookouts_.end(), works);
  };
  for (auto lookout = next(); credit_.left_us() > 0 && lookout != lookouts_.end(); lookout = next()) {
    searched_last_ = lookout->first;
    credit_.spend(lookout->second.finder.step(map, places_, options, counts_));
  }
}

std::vector<LostRobot> Frozen::lost(const std::function<bool(const std::string& robot)>& is_placed,
                                    const EngineOptions& options) const {
  std::vector<LostRobot> lost;
  for (const auto& [name, given] : given_)
    if (is_told(given)) lost.push_back({name, given.why, 0, 0, is_placed(name)});
  for (const auto& [name, lookout] : lookouts_) {
    if (const auto given = given_.find(name); given != given_.end() && is_told(given->second)) continue;
    const NotFound why = is_placed(name) ? NotFound::trying_a_place : lookout.finder.why(options.finder);
    lost.push_back({name, why, lookout.finder.way_m(), options.finder.min_piece_way_m, false});
  }
  return lost;
}

bool Frozen::has_work() const {
  return std::ranges::any_of(lookouts_, [](const auto& entry) { return entry.second.finder.has_work(); });
}

}  // namespace isthmus
