#include "tools/simulate/campaigns/features/rendezvous_experiment.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <numbers>

#include "server/features/feature_filter.hpp"
#include "server/features/state/correction.hpp"
#include "server/features/state/measurement.hpp"
#include "server/features/unicycle_noise.hpp"
#include "tools/simulate/campaigns/features/meeting.hpp"
#include "tools/simulate/plan/random.hpp"

namespace isthmus {
namespace {

constexpr double corridor_width_m = 80, corridor_depth_m = 60,
                 round_m = 2 * (corridor_width_m + corridor_depth_m);
constexpr int corner_count = 124;
constexpr double corner_reach_m = 8;  // as the laser's
constexpr double drive_step_m = 0.2;
constexpr double look_each_rad = 0.2;  // turned

/// Where the corridor is after s metres eastwards from (0, 0), and which way it goes there.
Pose on_corridor(double s) {
  s = std::fmod(std::fmod(s, round_m) + round_m, round_m);
  if (s < corridor_width_m) return {s, 0, 0};
  if (s < corridor_width_m + corridor_depth_m)
    return {corridor_width_m, s - corridor_width_m, 0.5 * std::numbers::pi};
  if (s < 2 * corridor_width_m + corridor_depth_m)
    return {2 * corridor_width_m + corridor_depth_m - s, corridor_depth_m, std::numbers::pi};
  return {0, round_m - s, -0.5 * std::numbers::pi};
}

/// How a corner errs in each axis as scanmatch/features finds it with the laser of Benedettelli et al.
/// (2012), 181 beams, 3 mm and 3 mrad: measured .0035 m at 2 m, .0047 at 3, .007 at 4, .011 at 5, .0145 at 6.
double corner_sigma_of_laser_m(double range_m) { return std::hypot(0.003, 0.0004 * range_m * range_m); }

struct Corner {
  double along_m = 0;  ///< along the corridor
  Eigen::Vector2d position;
};

std::vector<Corner> corners(Random& random) {
  std::vector<Corner> all;
  for (int i = 0; i < corner_count; ++i) {
    const double s = (i + 0.5 + random.uniform(-0.3, 0.3)) * round_m / corner_count;
    const double side = (random.chance(0.5) ? 1 : -1) * random.uniform(1, 2);
    all.push_back({s, on_corridor(s) * Eigen::Vector2d(0, side)});
  }
  return all;
}

/// One robot's map of its way; which corner is which is known to it, as section IV has it for each robot
/// alone.
class Mapper {
 public:
  Mapper(const std::vector<Corner>& corners, Random random, const RendezvousConditions& options)
      : corners_(corners), random_(random), options_(options), ids_(corners.size(), -1) {
    filter_.add_robot({}, Eigen::Matrix3d::Zero());
  }

  /// Along the corridor from s to s, the robot looking where it goes.
  void drive(double from, double to) {
    const bool forward = to > from;
    const int steps = static_cast<int>(std::abs(to - from) / drive_step_m);
    for (int i = 0; i <= steps; ++i) {
      const double s = from + (forward ? 1 : -1) * i * drive_step_m;
      const Pose there = forward ? on_corridor(s) : on_corridor(s) * Pose{0, 0, std::numbers::pi};
      if (!begun_) begin(there, s);
      go(there, s);
    }
  }

  const FeatureState& state() const { return filter_.state(); }
  const Pose& truth() const { return truth_; }
  const Pose& start() const { return start_; }
  std::vector<int> corner_of_id() const {
    std::vector<int> corner_of(state().features.size(), -1);
    for (std::size_t i = 0; i < ids_.size(); ++i)
      if (ids_[i] >= 0) corner_of[static_cast<std::size_t>(ids_[i])] = static_cast<int>(i);
    return corner_of;
  }

 private:
  /// Stands and looks: what it sees first is what all its map hangs on.
  void begin(const Pose& there, double s) {
    begun_ = true;
    start_ = truth_ = there;
    for (int i = 0; i < options_.looks_at_start; ++i) look(s);
  }

  /// Straight there, and on the spot into the direction there: looks as it turns, as a laser does.
  void go(const Pose& there, double s) {
    const double turn = wrap_angle(there.yaw - truth_.yaw);
    const int parts = std::max(1, static_cast<int>(std::ceil(std::abs(turn) / look_each_rad)));
    for (int part = 1; part <= parts; ++part) {
      const Pose next{there.x, there.y, wrap_angle(truth_.yaw + turn / parts)};
      move(ominus(next, truth_));
      truth_ = next;
      look(s);
    }
  }

  void move(const Pose& old_from_new) {
    OdometryStep step = unicycle_step(std::hypot(old_from_new.x, old_from_new.y), old_from_new.yaw, 1, {});
    step.covariance(1, 1) = 1e-6;
    const Pose noise{draw(std::sqrt(step.covariance(0, 0))), draw(1e-3),
                     draw(std::sqrt(step.covariance(2, 2)))};
    filter_.move(
        0, {old_from_new.x + noise.x, old_from_new.y + noise.y, wrap_angle(old_from_new.yaw + noise.yaw)},
        step.covariance);
  }

  double draw(double sigma) { return (options_.exact ? 0 : 1) * random_.normal(sigma); }

  void look(double s) {
    std::vector<ObservedFeature> seen;
    std::vector<int> known;
    std::vector<std::size_t> which;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      const double along = std::remainder(corners_[i].along_m - s, round_m);
      const Eigen::Vector2d there = inverse(truth_) * corners_[i].position;
      if (std::abs(along) > corner_reach_m || there.norm() > corner_reach_m || there.x() < 0) continue;
      const double sigma =
          options_.corner_sigma_m > 0 ? options_.corner_sigma_m : corner_sigma_of_laser_m(there.norm());
      const Eigen::Vector2d noise(draw(sigma), draw(sigma));
      seen.push_back({point_feature(there + noise), sigma * sigma * LocalMatrix::Identity(2, 2)});
      known.push_back(ids_[i]);
      which.push_back(i);
    }
    const std::vector<int> now = filter_.observe_known(0, seen, known);
    for (std::size_t k = 0; k < now.size(); ++k) ids_[which[k]] = now[k];
  }

  const std::vector<Corner>& corners_;
  Random random_;
  RendezvousConditions options_;
  FeatureFilter filter_;
  std::vector<int> ids_;
  Pose truth_, start_;
  bool begun_ = false;
};

double largest_3_sigma_m(const FeatureState& state) {
  double largest = 0;
  for (std::size_t i = 0; i < state.features.size(); ++i) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> axes(Eigen::Matrix2d(feature_covariance(state, i)));
    largest = std::max(largest, axes.eigenvalues()(1));
  }
  return 3 * std::sqrt(largest);
}

}  // namespace

RendezvousExperiment run_rendezvous_experiment(std::uint64_t seed, const RendezvousConditions& options) {
  Random building(seed, "corners");
  const std::vector<Corner> all = corners(building);
  Mapper one(all, Random(seed, "robot 1"), options), two(all, Random(seed, "robot 2"), options);
  one.drive(0, 208);    // east, north, and west along the far side,
  one.drive(208, 10);   // and back
  two.drive(160, 276);  // west along the far side, and south, until they see one another
  RendezvousExperiment experiment;
  experiment.one = one.state();
  experiment.two = two.state();
  experiment.corner_of_one = one.corner_of_id();
  experiment.corner_of_two = two.corner_of_id();
  experiment.truth_of_two = ominus(two.truth(), one.start());
  experiment.alignment = align_at_meeting(ominus(two.truth(), one.truth()), Random(seed, "rendezvous"));
  return experiment;
}

double least_3_sigma_m(std::uint64_t seed, RendezvousConditions options) {
  options.exact = true;
  RendezvousExperiment experiment = run_rendezvous_experiment(seed, options);
  const FeatureState &one = experiment.one, &two = experiment.two;
  experiment.alignment.one_from_two = ominus(experiment.truth_of_two, one.robots[0].map_from_robot);
  FeatureState joint = aligned(one, 0, two, 0, experiment.alignment);
  for (std::size_t i = 0; i < one.features.size(); ++i) {
    const int corner = experiment.corner_of_one[static_cast<std::size_t>(one.features[i].id)];
    for (std::size_t k = 0; k < two.features.size(); ++k) {
      if (experiment.corner_of_two[static_cast<std::size_t>(two.features[k].id)] != corner) continue;
      const auto same = measure_identity(joint, i, one.features.size() + k, 1e-3);
      if (same) correct(joint, {&*same, 1});
    }
  }
  return largest_3_sigma_m(joint);
}

RendezvousScore judge_fusion(const RendezvousExperiment& experiment) {
  const FeatureState plain = aligned(experiment.one, 0, experiment.two, 0, experiment.alignment);
  const std::clock_t start = std::clock();
  const Fusion fusion = fuse(experiment.one, 0, experiment.two, 0, experiment.alignment);
  RendezvousScore score;
  score.fusion_cpu_ms = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  score.corners_1 = experiment.one.features.size();
  score.corners_2 = experiment.two.features.size();
  for (const int corner : experiment.corner_of_two)
    score.duplicates += static_cast<std::size_t>(
        std::count(experiment.corner_of_one.begin(), experiment.corner_of_one.end(), corner));
  for (const Fusion::Duplicate& pair : fusion.duplicates) {
    const auto second = static_cast<std::size_t>(pair.gone - experiment.one.next_id);
    const bool right =
        experiment.corner_of_one[static_cast<std::size_t>(pair.kept)] == experiment.corner_of_two[second];
    ++(right ? score.found : score.wrong);
  }
  score.before_3_sigma_m = largest_3_sigma_m(plain);
  score.after_3_sigma_m = largest_3_sigma_m(fusion.state);
  score.nees_before = pose_nees(plain, 1, experiment.truth_of_two) / 3;
  score.nees_after = pose_nees(fusion.state, 1, experiment.truth_of_two) / 3;
  return score;
}

RendezvousScore mean_of(const std::vector<RendezvousScore>& scores) {
  RendezvousScore mean;
  const double share = 1 / static_cast<double>(std::max<std::size_t>(1, scores.size()));
  for (const RendezvousScore& one : scores) {
    mean.corners_1 += one.corners_1;
    mean.corners_2 += one.corners_2;
    mean.duplicates += one.duplicates;
    mean.found += one.found;
    mean.wrong += one.wrong;
    mean.before_3_sigma_m += share * one.before_3_sigma_m;
    mean.after_3_sigma_m += share * one.after_3_sigma_m;
    mean.least_3_sigma_m += share * one.least_3_sigma_m;
    mean.nees_before += share * one.nees_before;
    mean.nees_after += share * one.nees_after;
    mean.fusion_cpu_ms += share * one.fusion_cpu_ms;
  }
  return mean;
}

}  // namespace isthmus
