#include "tools/simulate/campaigns/features/features.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "scanmatch/features/scan_features.hpp"
#include "server/features/fusion/fusion.hpp"
#include "server/features/unicycle_noise.hpp"
#include "tools/simulate/campaigns/features/meeting.hpp"
#include "tools/simulate/plan/random.hpp"

namespace isthmus {
namespace {

/// A scan with the odometry since the one before it.
struct DriveStep {
  std::int64_t utime = 0;
  Pose old_from_new;
  double seconds = 0;
  const Scan* scan = nullptr;
  Pose truth;  ///< in the frame of the robot's start
};

struct Drive {
  Laser laser;
  Pose world_from_start;
  std::vector<DriveStep> steps;
};

Drive drive_of(const SimulatedRun& run, const RobotTruth& truth) {
  Drive drive;
  Pose now, last;
  for (const Event& event : run.events) {
    if (const auto* robot = std::get_if<RobotEvent>(&event.body);
        robot != nullptr && robot->robot == truth.robot)
      drive.laser = robot->laser;
    if (const auto* odometry = std::get_if<OdometryEvent>(&event.body);
        odometry != nullptr && odometry->robot == truth.robot)
      now = odometry->odom_from_robot;
    const auto* scan = std::get_if<ScanEvent>(&event.body);
    if (scan == nullptr || scan->robot != truth.robot || drive.steps.size() == truth.poses.size()) continue;
    const TruePose& here = truth.poses[drive.steps.size()];
    if (drive.steps.empty()) drive.world_from_start = here.world_from_robot;
    DriveStep step{
        scan->scan.utime, {}, 0, &scan->scan, ominus(here.world_from_robot, drive.world_from_start)};
    if (!drive.steps.empty()) {
      step.old_from_new = ominus(now, last);
      step.seconds = 1e-6 * static_cast<double>(step.utime - drive.steps.back().utime);
    }
    last = now;
    drive.steps.push_back(step);
  }
  return drive;
}

/// Odometry's step with the noise of the paper, and a hundredth sideways: it drives arcs, told as chords.
OdometryStep noisy(const DriveStep& step) {
  const double distance = std::hypot(step.old_from_new.x, step.old_from_new.y);
  if (distance < 1e-6 && std::abs(step.old_from_new.yaw) < 1e-6)
    return {step.old_from_new, Eigen::Matrix3d::Zero()};
  UnicycleNoise noise;
  noise.slip_share = 0.01;
  OdometryStep result =
      unicycle_step(distance / step.seconds, step.old_from_new.yaw / step.seconds, step.seconds, noise);
  result.old_from_new = step.old_from_new;
  return result;
}

/// One robot of a filter, on its way.
class DriveReader {
 public:
  DriveReader(const Drive& drive, int robot, const FeatureCampaignOptions& options)
      : drive_(&drive), robot_(robot), options_(options) {
    features_.noise = {0.003, 0.003, options.surface_sigma_m};
  }

  /// The next step; its pose is judged in the frame of `start`, the frame of the filter as seen from the
  /// robot's own.
  void step(FeatureFilter& filter, const Pose& own_from_map) {
    const DriveStep& step = drive_->steps[next_++];
    const OdometryStep odometry = noisy(step);
    filter.move(robot_, odometry.old_from_new, odometry.covariance);
    driven_m_ += std::hypot(step.old_from_new.x, step.old_from_new.y);
    turned_rad_ += std::abs(step.old_from_new.yaw);
    if (next_ == 1 || driven_m_ > options_.observe_every_m || turned_rad_ > options_.observe_every_rad) {
      driven_m_ = turned_rad_ = 0;
      std::vector<ObservedFeature> seen;
      for (const ScanSegment& segment : find_features(*step.scan, drive_->laser, features_).segments)
        seen.push_back(segment.observed);
      filter.observe(robot_, seen);
    }
    const Pose truth = inverse(own_from_map) * step.truth;
    const Pose& found = filter.state().robots[static_cast<std::size_t>(robot_)].map_from_robot;
    sum_.position_m += std::hypot(found.x - truth.x, found.y - truth.y);
    sum_.orientation_deg += std::abs(wrap_angle(found.yaw - truth.yaw)) * 180 / std::numbers::pi;
    sum_.nees += pose_nees(filter.state(), robot_, truth) / 3;
  }

  bool done() const { return next_ == drive_->steps.size(); }
  std::int64_t utime() const {
    return done() ? std::numeric_limits<std::int64_t>::max() : drive_->steps[next_].utime;
  }
  /// The same on its way with another filter, where it is robot `robot`.
  DriveReader as(int robot) const {
    DriveReader other = *this;
    other.robot_ = robot;
    return other;
  }

  FeatureColumn column() const {
    FeatureColumn mean = sum_;
    const auto steps = static_cast<double>(std::max<std::size_t>(1, next_));
    for (double* value : {&mean.position_m, &mean.orientation_deg, &mean.nees}) *value /= steps;
    return mean;
  }

 private:
  const Drive* drive_;
  int robot_;
  FeatureCampaignOptions options_;
  ScanFeatureOptions features_;
  std::size_t next_ = 0;
  double driven_m_ = 0, turned_rad_ = 0;
  FeatureColumn sum_;
};

FilterOptions filter_options(const FeatureCampaignOptions& options) {
  FilterOptions result;
  result.form = options.form;
  result.association.pairing = options.pairing;
  return result;
}

double cpu_now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Alone {
  FeatureFilter filter;
  DriveReader traveller;

  Alone(const Drive& drive, const FeatureCampaignOptions& options)
      : filter(filter_options(options)), traveller(drive, 0, options) {
    filter.add_robot({}, Eigen::Matrix3d::Zero());
  }
  void until(std::int64_t utime) {
    while (traveller.utime() < utime) traveller.step(filter, {});
    filter.gather();
  }
};

FeatureColumn judged(const FeatureFilter& filter, const DriveReader& traveller, const FloorPlan& plan,
                     const Pose& world_from_map, double cpu_s) {
  FeatureColumn column = traveller.column();
  column.cpu_s = cpu_s;
  judge_walls(filter.state(), plan, world_from_map, column);
  return column;
}

/// The first time at which one has seen the other.
std::optional<std::int64_t> first_meeting(const SimulatedRun& run, const RobotTruth& one,
                                          const RobotTruth& two) {
  std::int32_t worn = -1;
  for (const Event& event : run.events) {
    if (const auto* robot = std::get_if<RobotEvent>(&event.body);
        robot != nullptr && robot->robot == two.robot)
      worn = robot->barcode;
    if (const auto* sighting = std::get_if<SightingEvent>(&event.body);
        sighting != nullptr && sighting->robot == one.robot && sighting->barcode == worn)
      return sighting->utime;
  }
  return std::nullopt;
}

/// The map of one robot with the other's fused into it, on their way from the rendezvous. It is made at the
/// rendezvous if they have a feature in common then; else as soon as they have.
class Together {
 public:
  Together(const Alone& own, const Alone& other, const Drive& own_drive, const Drive& other_drive,
           const RobotAlignment& alignment)
      : filter_(own.filter),
        other_filter_(other.filter),
        alignment_(alignment),
        own_(own.traveller.as(0)),
        other_(other.traveller.as(0)),
        own_start_(own_drive.world_from_start),
        other_from_own_(ominus(own_drive.world_from_start, other_drive.world_from_start)),
        own_mark_{filter_.add_mark(0), true},
        other_mark_{other_filter_.add_mark(0), true} {
    look_for_common();
  }

  void until(std::int64_t utime) {
    const double start = cpu_now();
    while (std::min(own_.utime(), other_.utime()) < utime) {
      if (own_.utime() <= other_.utime())
        own_.step(filter_, {});
      else if (duplicates_ > 0)
        other_.step(filter_, other_from_own_);
      else
        other_.step(other_filter_, {});
      if (duplicates_ == 0) look_for_common();
    }
    cpu_s_ += cpu_now() - start;
  }

  /// As they are, or as the rendezvous alone puts them.
  FeatureColumn column(const FloorPlan& plan) {
    filter_.gather();
    other_filter_.gather();
    FeatureFilter joint = filter_;
    if (duplicates_ == 0) joint.replace(fused().state);
    return judged(joint, own_, plan, own_start_, cpu_s_);
  }
  std::size_t duplicates() const { return duplicates_; }

 private:
  static constexpr std::size_t more_features = 8;  ///< from which it is worth while to look again

  Fusion fused() const {
    return fuse(filter_.state(), own_mark_, other_filter_.state(), other_mark_, alignment_);
  }

  void look_for_common() {
    const std::size_t features = filter_.feature_count() + other_filter_.feature_count();
    if (features < looked_at_ + more_features) return;
    looked_at_ = features;
    filter_.gather();
    other_filter_.gather();
    Fusion fusion = fused();
    if (fusion.duplicates.empty()) return;
    duplicates_ = fusion.duplicates.size();
    other_ = other_.as(static_cast<int>(filter_.state().robots.size()));
    const int ids = filter_.state().next_id;
    filter_.replace(std::move(fusion.state));
    filter_.remove_mark(own_mark_.which);
    filter_.remove_mark(other_mark_.which + ids);
  }

  FeatureFilter filter_;
  FeatureFilter other_filter_;  ///< until they are one
  RobotAlignment alignment_;
  DriveReader own_, other_;
  Pose own_start_, other_from_own_;
  PoseOwner own_mark_, other_mark_;  ///< where they met
  std::size_t looked_at_ = 0;
  std::size_t duplicates_ = 0;
  double cpu_s_ = 0;
};

void drive_together(FeatureTrial& trial, const std::array<Drive, 2>& drives, const std::array<Alone*, 2>& met,
                    const FloorPlan& plan, std::uint64_t seed) {
  constexpr std::int64_t end = std::numeric_limits<std::int64_t>::max();
  const std::size_t last = drives[0].steps.size() - 1;
  const std::int64_t half = drives[0].steps[last / 2].utime;
  const auto pose_at = [&](std::size_t robot) {
    const auto after =
        std::find_if(drives[robot].steps.begin(), drives[robot].steps.end(),
                     [&](const DriveStep& step) { return step.utime >= met[robot]->traveller.utime(); });
    return drives[robot].world_from_start * std::prev(after)->truth;
  };
  const RobotAlignment alignment =
      align_at_meeting(ominus(pose_at(1), pose_at(0)), Random(seed, "features rendezvous"));
  const RobotAlignment back =
      align_at_meeting(ominus(pose_at(0), pose_at(1)), Random(seed, "features rendezvous"));
  for (const std::size_t own : {0U, 1U}) {
    const std::size_t other = 1 - own;
    Together joint(*met[own], *met[other], drives[own], drives[other], own == 0 ? alignment : back);
    joint.until(half);
    trial.columns[4 + own] = joint.column(plan);
    joint.until(end);
    trial.columns[2 + own] = joint.column(plan);
    if (own == 0) trial.duplicates = joint.duplicates();
  }
}

/// Ends of surfaces and where they cross: where a wall may be seen to end.
std::vector<Eigen::Vector2d> true_ends(const FloorPlan& plan) {
  std::vector<Eigen::Vector2d> ends;
  for (const Segment& one : plan.segments) {
    ends.push_back(one.a);
    for (const Segment& other : plan.segments) {
      const Eigen::Vector2d u = one.b - one.a, v = other.b - other.a, w = other.a - one.a;
      const double cross = u.x() * v.y() - u.y() * v.x();
      if (std::abs(cross) < 1e-6 * u.norm() * v.norm()) continue;
      const double s = (w.x() * v.y() - w.y() * v.x()) / cross, t = (w.x() * u.y() - w.y() * u.x()) / cross;
      if (s >= 0 && s <= 1 && t >= 0 && t <= 1) ends.push_back(one.a + s * u);
    }
  }
  return ends;
}

/// The surface along which a wall lies: within 0.5 m of its middle and 10 degrees of its direction, the
/// nearest.
const Segment* surface_of(const FloorPlan& plan, const Feature& wall) {
  const Eigen::Vector2d middle = 0.5 * (wall.a + wall.b);
  const Segment* nearest = nullptr;
  double least = 0.5;
  for (const Segment& surface : plan.segments) {
    const Eigen::Vector2d t = (surface.b - surface.a).normalized();
    if (std::abs(t.dot(across(wall))) > 0.17) continue;
    const double distance = distance_m(middle, surface);
    if (distance >= least) continue;
    least = distance;
    nearest = &surface;
  }
  return nearest;
}

}  // namespace

void judge_walls(const FeatureState& state, const FloorPlan& plan, const Pose& world_from_map,
                 FeatureColumn& column) {
  const std::vector<Eigen::Vector2d> ends = true_ends(plan);
  for (const FeatureInState& entry : state.features) {
    const Feature wall = world_from_map * entry.feature;
    column.features += 1;
    for (const bool first : {true, false}) {
      if (!(first ? wall.end_a_known : wall.end_b_known)) continue;
      double least = std::numeric_limits<double>::infinity();
      for (const Eigen::Vector2d& end : ends)
        least = std::min(least, (end - (first ? wall.a : wall.b)).norm());
      column.endpoint_m += least;
      column.endpoints += 1;
    }
    const Segment* surface = surface_of(plan, wall);
    if (surface == nullptr) continue;
    Eigen::Vector2d t = (surface->b - surface->a).normalized();
    if (t.dot(along(wall)) < 0) t = -t;
    const Eigen::Vector2d n(t.y(), -t.x()), origin = position(world_from_map);
    column.alpha_deg +=
        std::abs(std::asin(std::clamp(t.dot(across(wall)), -1.0, 1.0))) * 180 / std::numbers::pi;
    column.rho_m += std::abs(n.dot(surface->a - origin) - across(wall).dot(wall.a - origin));
    column.middle_m += std::abs(n.dot(0.5 * (wall.a + wall.b) - surface->a));
    column.matched += 1;
  }
  column.alpha_deg /= std::max(1.0, column.matched);
  column.rho_m /= std::max(1.0, column.matched);
  column.middle_m /= std::max(1.0, column.matched);
  column.endpoint_m /= std::max(1.0, column.endpoints);
}

FeatureTrial try_features(const SimulatedRun& run, const FloorPlan& plan, std::uint64_t seed,
                          const FeatureCampaignOptions& options) {
  if (run.truth.size() < 2) throw std::runtime_error("two robots are needed");
  const std::array<Drive, 2> drives = {drive_of(run, run.truth[0]), drive_of(run, run.truth[1])};
  if (drives[0].steps.empty() || drives[1].steps.empty()) throw std::runtime_error("a robot took no scan");
  FeatureTrial trial;
  Alone one(drives[0], options), two(drives[1], options);
  std::optional<std::int64_t> met = first_meeting(run, run.truth[0], run.truth[1]);
  if (options.meet_after_s)
    met = drives[0].steps.front().utime + static_cast<std::int64_t>(1e6 * *options.meet_after_s);
  if (met) {
    trial.met_s = 1e-6 * static_cast<double>(*met - drives[0].steps.front().utime);
    one.until(*met);
    two.until(*met);
    if (!one.traveller.done() && !two.traveller.done())
      drive_together(trial, drives, {&one, &two}, plan, seed);
  }
  for (const std::size_t robot : {0U, 1U}) {
    Alone& alone = robot == 0 ? one : two;
    const double start = cpu_now();
    alone.until(std::numeric_limits<std::int64_t>::max());
    trial.columns[robot] =
        judged(alone.filter, alone.traveller, plan, drives[robot].world_from_start, cpu_now() - start);
  }
  return trial;
}

FeatureColumn mean_of(const std::vector<FeatureTrial>& trials, FeatureColumnId column) {
  FeatureColumn mean;
  double count = 0;
  const auto values = [](FeatureColumn& c) {
    return std::array{&c.position_m, &c.orientation_deg, &c.nees,      &c.alpha_deg, &c.rho_m, &c.middle_m,
                      &c.endpoint_m, &c.features,        &c.endpoints, &c.matched,   &c.cpu_s};
  };
  for (const FeatureTrial& trial : trials) {
    auto found = trial.columns[static_cast<std::size_t>(column)];
    if (!found) continue;
    count += 1;
    const auto from = values(*found), to = values(mean);
    for (std::size_t k = 0; k < to.size(); ++k) *to[k] += *from[k];
  }
  for (double* value : values(mean)) *value /= std::max(1.0, count);
  return mean;
}

}  // namespace isthmus
