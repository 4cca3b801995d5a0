#include "tools/simulate/run/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <tuple>

#include "tools/simulate/run/laser_model.hpp"
#include "tools/simulate/run/odometry_model.hpp"
#include "tools/simulate/run/traffic.hpp"
#include "tools/simulate/run/unicycle.hpp"

namespace isthmus {
namespace {

constexpr double robot_message_period_s = 5;
constexpr double blind_truth_hz = 10;

// What the order of events of one robot at one time is decided by.
enum class Rank { robot, odometry, scan, sighting };

struct Draft {
  std::int64_t utime = 0;
  std::size_t robot = 0;
  Rank rank = Rank::robot;
  Event event;
  std::optional<TrueSighting> truth;  // of a sighting
  std::string false_kind;             // of a false one
};

// Everything that stays the same during a run.
struct World {
  const Scenario& scenario;
  std::uint64_t seed;
  std::vector<RayCaster> casters;  // of the scenario's plan, then of its changes
  std::vector<TruePath> paths;
  double end_s = 0;

  const RayCaster& caster_at(double time_s) const {
    const auto& changes = scenario.changes;
    const auto next = std::ranges::upper_bound(changes, time_s, {}, &BuildingChange::from_s);
    return casters[static_cast<std::size_t>(next - changes.begin())];
  }
  std::int64_t utime(double time_s) const { return scenario.start_utime + std::llround(time_s * 1e6); }
};

void check_path(const RobotPlan& robot, const TruePath& path, const RayCaster& caster) {
  for (const PathStretch& stretch : path.stretches()) {
    for (std::size_t i = 0; i < stretch.world_from_robot.size(); i += 4) {
      const Pose& pose = stretch.world_from_robot[i];
      if (!caster.touches({pose.x, pose.y}, robot.radius_m)) continue;
      std::ostringstream reason;
      reason << robot.name << " runs into a wall at (" << pose.x << ", " << pose.y << ")";
      throw std::runtime_error(reason.str());
    }
  }
}

World make_world(const Scenario& scenario, std::uint64_t seed) {
  World world{scenario, seed, {}, {}, 0};
  world.casters.emplace_back(scenario.plan);
  for (const BuildingChange& change : scenario.changes) world.casters.emplace_back(change.plan);
  std::vector<double> radii_m;
  for (const RobotPlan& robot : scenario.robots) {
    world.paths.push_back(drive(robot, seed));
    for (const RayCaster& caster : world.casters) check_path(robot, world.paths.back(), caster);
    radii_m.push_back(robot.radius_m);
  }
  if (scenario.robots_give_way) give_way(world.paths, radii_m);
  for (std::size_t i = 0; i < world.paths.size(); ++i)
    if (!scenario.robots[i].silent) world.end_s = std::max(world.end_s, world.paths[i].end_s());
  if (scenario.duration_s > 0) world.end_s = scenario.duration_s;
  return world;
}

int worn_by(const RobotPlan& robot) { return robot.silent ? -1 : robot.barcode; }

// One robot's part of the run.
class RobotRun {
 public:
  RobotRun(const World& world, std::size_t index, std::vector<Draft>& drafts, RobotTruth& truth)
      : world_(world),
        index_(index),
        plan_(world.scenario.robots[index]),
        path_(world.paths[index]),
        laser_random_(world.seed, plan_.name + " laser"),
        camera_random_(world.seed, plan_.name + " camera"),
        drafts_(drafts),
        truth_(truth) {}

  void record() {
    Random phases(world_.seed, plan_.name + " phases");
    const std::set<double> scans = ticks(plan_.laser.rate_hz, phases.uniform());
    std::set<double> odometry = ticks(plan_.odometry.rate_hz, phases.uniform());
    odometry.insert(scans.begin(), scans.end());
    tell_of_itself();
    count_wheels(odometry);
    for (const double time_s : scans) scan(time_s);
    if (scans.empty()) note_truth(odometry);
    for (const double time_s : ticks(plan_.camera.rate_hz, phases.uniform())) {
      if (time_s >= plan_.camera.from_s) look(time_s);
    }
  }

 private:
  // The times, `rate_hz` a second, at which the robot is on its wheels.
  std::set<double> ticks(double rate_hz, double phase) const {
    std::set<double> times;
    if (rate_hz <= 0) return times;
    for (double k = phase; k / rate_hz < world_.end_s; ++k) {
      if (path_.stretch_at(k / rate_hz)) times.insert(k / rate_hz);
    }
    return times;
  }

  void add(double time_s, Rank rank, decltype(Event::body) body, std::optional<TrueSighting> truth = {}) {
    const std::int64_t utime = world_.utime(time_s);
    drafts_.push_back({utime, index_, rank, Event{utime, std::move(body)}, truth, {}});
  }

  void tell_of_itself() {
    for (std::size_t i = 0; i < path_.stretches().size(); ++i) {
      const PathStretch& stretch = path_.stretches()[i];
      const bool last = i + 1 == path_.stretches().size();
      const double until_s = std::min(world_.end_s, last ? world_.end_s : stretch.end_s());
      for (double time_s = stretch.start_s; time_s < until_s; time_s += robot_message_period_s) {
        RobotEvent event{plan_.name,     world_.utime(time_s),
                         plan_.barcode,  declared_laser(plan_.laser),
                         plan_.radius_m, i > 0 && stretch.announced && time_s == stretch.start_s};
        add(time_s, Rank::robot, event);
      }
    }
  }

  void count_wheels(const std::set<double>& times) {
    OdometryModel odometry(plan_.odometry, Random(world_.seed, plan_.name + " odometry"));
    std::optional<std::size_t> stretch;
    double before_s = 0;
    std::vector<std::optional<Pose>> frozen(plan_.freezes.size());
    for (const double time_s : times) {
      const std::size_t now = *path_.stretch_at(time_s);
      if (stretch == now) {
        odometry.advance(path_.at(now, before_s), path_.at(now, time_s), time_s - before_s);
      } else if (path_.stretches()[now].odometry_restarts) {
        odometry.restart();
      }
      stretch = now;
      before_s = time_s;
      Pose reported = odometry.pose();
      for (std::size_t i = 0; i < frozen.size(); ++i) {
        const Freeze& freeze = plan_.freezes[i];
        if (time_s < freeze.from_s || time_s >= freeze.to_s) continue;
        if (!frozen[i]) frozen[i] = odometry.pose();
        reported = *frozen[i];
      }
      add(time_s, Rank::odometry, OdometryEvent{plan_.name, world_.utime(time_s), reported});
    }
  }

  void scan(double time_s) {
    const std::size_t stretch = *path_.stretch_at(time_s);
    const double taken_s = time_s - plan_.laser.scan_lag_s;
    const Pose pose = path_.at(stretch, taken_s);
    std::vector<Passerby> bodies;
    for (std::size_t other = 0; world_.scenario.bodies_visible && other < world_.paths.size(); ++other) {
      if (other == index_) continue;
      const auto body = world_.paths[other].at(taken_s);
      if (body) bodies.push_back({{body->x, body->y}, world_.scenario.robots[other].radius_m});
    }
    const LaserPlan& laser = plan_.laser;
    const bool aside = laser.interlaced && truth_.poses.size() % 2 == 1;
    const double shift_rad = aside ? 0.5 * laser.field_of_view_rad / std::max(1, laser.beams - 1) : 0;
    ScanEvent event{plan_.name,
                    take_scan(laser, world_.caster_at(taken_s), pose, bodies, laser_random_, shift_rad)};
    event.scan.utime = world_.utime(time_s);
    truth_.poses.push_back({event.scan.utime, stretch, pose});
    add(time_s, Rank::scan, std::move(event));
  }

  // Of a robot without a laser: at stamps of its odometry, at most `blind_truth_hz` a second.
  void note_truth(const std::set<double>& times) {
    double next_s = 0;
    for (const double time_s : times) {
      if (time_s < next_s) continue;
      const std::size_t stretch = *path_.stretch_at(time_s);
      truth_.poses.push_back({world_.utime(time_s), stretch, path_.at(stretch, time_s)});
      next_s = time_s + 1 / blind_truth_hz - 1e-6;
    }
  }

  void look(double time_s) {
    const Pose pose = *path_.at(time_s);
    for (std::size_t other = 0; other < world_.paths.size(); ++other) {
      const auto target = world_.paths[other].at(time_s);
      if (other != index_ && target)
        read_code(time_s, pose, {target->x, target->y}, worn_by(world_.scenario.robots[other]));
    }
    for (const TagPlan& tag : world_.scenario.tags) read_code(time_s, pose, tag.position, tag.barcode);
  }

  void read_code(double time_s, const Pose& pose, const Eigen::Vector2d& target, int barcode) {
    if (barcode < 0 || !in_sight(plan_.camera, world_.caster_at(time_s), pose, target)) return;
    if (!camera_random_.chance(plan_.camera.detection_share)) return;
    const TrueSighting truth = true_sighting(pose, target, barcode);
    SightingEvent event = measure(plan_.camera, truth, camera_random_);
    event.robot = plan_.name;
    event.utime = world_.utime(time_s);
    add(time_s, Rank::sighting, event, truth);
  }

  const World& world_;
  std::size_t index_;
  const RobotPlan& plan_;
  const TruePath& path_;
  Random laser_random_;
  Random camera_random_;
  std::vector<Draft>& drafts_;
  RobotTruth& truth_;
};

std::vector<int> all_barcodes(const Scenario& scenario) {
  std::vector<int> barcodes;
  for (const RobotPlan& robot : scenario.robots)
    if (!robot.silent) barcodes.push_back(robot.barcode);
  for (const TagPlan& tag : scenario.tags) barcodes.push_back(tag.barcode);
  return barcodes;
}

// A reading of a robot that is not in sight at the time; nothing where a few tries find none.
std::optional<Draft> phantom(const World& world, Random& random) {
  const auto& robots = world.scenario.robots;
  for (int tries = 0; tries < 200; ++tries) {
    const std::size_t observer = random.index(robots.size()), target = random.index(robots.size());
    const double time_s = random.uniform(0, world.end_s);
    if (time_s < robots[observer].camera.from_s || robots[observer].silent) continue;
    const auto pose = world.paths[observer].at(time_s), other = world.paths[target].at(time_s);
    if (observer == target || !pose || worn_by(robots[target]) < 0 || robots[observer].camera.rate_hz <= 0)
      continue;
    const CameraPlan& camera = robots[observer].camera;
    if (other && in_sight(camera, world.caster_at(time_s), *pose, {other->x, other->y})) continue;
    const TrueSighting imagined{robots[target].barcode, random.uniform(0.5, camera.range_max_m),
                                random.uniform(-0.5, 0.5) * camera.field_of_view_rad};
    SightingEvent event = measure(camera, imagined, random);
    event.robot = robots[observer].name;
    event.utime = world.utime(time_s);
    return Draft{event.utime, observer, Rank::sighting, Event{event.utime, event}, TrueSighting{}, "phantom"};
  }
  return std::nullopt;
}

// A third of the false sightings are phantoms, added; the rest are true ones spoilt.
void spoil_sightings(const World& world, std::vector<Draft>& drafts) {
  const double share = world.scenario.false_sightings;
  if (share <= 0) return;
  Random random(world.seed, "false sightings");
  const std::vector<int> barcodes = all_barcodes(world.scenario);
  double sightings = 0;
  for (Draft& draft : drafts) {
    if (draft.rank != Rank::sighting) continue;
    ++sightings;
    if (!random.chance(share * 2 / (3 - share))) continue;
    draft.false_kind = falsify(std::get<SightingEvent>(draft.event.body), barcodes, random);
  }
  const auto phantoms = static_cast<int>(std::lround(sightings * share / (3 - share)));
  for (int i = 0; i < phantoms; ++i) {
    if (auto draft = phantom(world, random)) drafts.push_back(std::move(*draft));
  }
}

void declare_tags(const Scenario& scenario, std::vector<Event>& events) {
  for (const TagPlan& tag : scenario.tags) {
    events.push_back({scenario.start_utime, TagEvent{scenario.start_utime, tag.barcode}});
  }
}

}  // namespace

SimulatedRun simulate(const Scenario& scenario, std::uint64_t seed) {
  const World world = make_world(scenario, seed);
  SimulatedRun run;
  std::vector<Draft> drafts;
  for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
    if (scenario.robots[i].silent) continue;
    run.truth.push_back({scenario.robots[i].name, {}});
    RobotRun(world, i, drafts, run.truth.back()).record();
  }
  spoil_sightings(world, drafts);
  std::ranges::stable_sort(drafts, {}, [](const Draft& d) { return std::tuple(d.utime, d.robot, d.rank); });

  declare_tags(scenario, run.events);
  std::size_t row = 0;
  for (Draft& draft : drafts) {
    if (draft.rank == Rank::sighting) ++row;
    if (!draft.false_kind.empty()) {
      run.false_sightings.push_back({row, std::get<SightingEvent>(draft.event.body), draft.false_kind,
                                     draft.truth.value_or(TrueSighting{})});
    }
    run.events.push_back(std::move(draft.event));
  }
  return run;
}

}  // namespace isthmus
