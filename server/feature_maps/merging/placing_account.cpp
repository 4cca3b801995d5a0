#include "server/feature_maps/merging/placing_account.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

namespace isthmus {
namespace {

struct Beside {
  double from_m = 0;  ///< along the first wall, from its a
  double to_m = 0;
};

/// Where two walls run beside one another, as far as they do so long enough.
std::optional<Beside> beside(const MapWall& one, const MapWall& there, double min_cosine,
                             const MergingOptions& options) {
  if (one.along.dot(there.along) < min_cosine) return std::nullopt;
  const double a = one.along.dot(there.a - one.a), b = one.along.dot(there.b - one.a);
  const Beside stretch{std::max(0.0, a), std::min(one.length_m, b)};
  const double enough = options.twin_overlap * std::min(one.length_m, there.length_m);
  if (stretch.to_m - stretch.from_m < enough) return std::nullopt;
  return stretch;
}

/// Of a place on the first wall's line to the other's, across the first.
double off_m(const MapWall& one, const MapWall& there, double at_m) {
  const Eigen::Vector2d place = one.a + at_m * one.along;
  const Eigen::Vector2d across = one.across();
  return across.dot(there.a - place) + there.along.dot(place - there.a) * across.dot(there.along);
}

std::vector<WallFate> fates(const std::vector<MapWall>& walls, const std::set<std::size_t>& with_twin,
                            const Pose& there, const FreeGround& ground, const MergingOptions& options) {
  std::vector<WallFate> result;
  for (std::size_t i = 0; i < walls.size(); ++i)
    result.push_back(with_twin.contains(i) ? WallFate::explained
                                           : fate_in(ground, there * walls[i], options));
  return result;
}

std::size_t count(const std::vector<WallFate>& fates, WallFate fate) {
  return static_cast<std::size_t>(std::count(fates.begin(), fates.end(), fate));
}

/// Walls that are contradicted, beyond the share that their own map contradicts.
double beyond_own(const std::vector<WallFate>& fates, double own_share) {
  const auto contradicted = static_cast<double>(count(fates, WallFate::contradicted));
  const auto there = static_cast<double>(fates.size() - count(fates, WallFate::beyond));
  return std::max(0.0, contradicted - own_share * there);
}

/// Of walls of two directions, those of the one that has fewer: what tells how far along the others it is.
std::size_t fewer_of_two_directions(const std::vector<MapWall>& walls, const std::set<std::size_t>& which) {
  if (which.empty()) return 0;
  const Eigen::Vector2d first = walls[*which.begin()].along;
  std::size_t along = 0;
  for (const std::size_t i : which) along += std::abs(walls[i].along.dot(first)) > std::sqrt(0.5) ? 1 : 0;
  return std::min(along, which.size() - along);
}

}  // namespace

std::vector<WallTwin> twins_at(const MapSketch& one, const MapSketch& two, const Pose& one_from_two,
                               double within_m, const MergingOptions& options) {
  const double min_cosine = std::cos(options.twin_rad);
  std::vector<WallTwin> twins;
  for (std::size_t k = 0; k < two.walls.size(); ++k) {
    const MapWall there = one_from_two * two.walls[k];
    std::optional<WallTwin> best;
    for (std::size_t i = 0; i < one.walls.size(); ++i) {
      const std::optional<Beside> stretch = beside(one.walls[i], there, min_cosine, options);
      if (!stretch) continue;
      const double off = std::abs(off_m(one.walls[i], there, 0.5 * (stretch->from_m + stretch->to_m)));
      if (off < (best ? best->off_m : within_m)) best = WallTwin{i, k, off};
    }
    if (best) twins.push_back(*best);
  }
  return twins;
}

Pose refined_placing(const MapSketch& one, const MapSketch& two, const Pose& start,
                     const MergingOptions& options) {
  constexpr double robust_m = 0.15;
  const double min_cosine = std::cos(options.twin_rad);
  Pose pose = start;
  for (const double within : {3.0, 2.0, 1.5, 1.0, 1.0}) {
    Eigen::Matrix3d sum = 1e-3 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d pull = Eigen::Vector3d::Zero();
    const Eigen::Vector2d centre = pose * two.middle;
    for (const WallTwin& twin : twins_at(one, two, pose, within * options.twin_m, options)) {
      const MapWall& wall = one.walls[twin.one];
      const MapWall there = pose * two.walls[twin.two];
      const std::optional<Beside> stretch = beside(wall, there, min_cosine, options);
      if (!stretch) continue;
      for (const double at : {stretch->from_m, stretch->to_m}) {
        const double off = off_m(wall, there, at);
        const Eigen::Vector2d across = wall.across(), arm = wall.a + at * wall.along - centre;
        const Eigen::Vector3d by(across.x(), across.y(), across.dot(quarter_turn(arm)));
        const double weight = 1 / (1 + std::pow(off / robust_m, 2));
        sum += weight * by * by.transpose();
        pull -= weight * off * by;
      }
    }
    const Eigen::Vector3d step = sum.ldlt().solve(pull);
    if (!step.allFinite()) break;
    pose.yaw = wrap_angle(pose.yaw + step.z());
    const Eigen::Vector2d offset = centre + step.head<2>() - rotate(pose.yaw, two.middle);
    pose.x = offset.x();
    pose.y = offset.y();
  }
  return pose;
}

PlacingAccount account_of(const MapSketch& one, const MapSketch& two, const Pose& one_from_two,
                          const MergingOptions& options) {
  PlacingAccount account;
  account.one_from_two = one_from_two;
  account.twins = twins_at(one, two, one_from_two, options.twin_m, options);
  std::set<std::size_t> with_twin_one, with_twin_two;
  for (const WallTwin& twin : account.twins) {
    with_twin_one.insert(twin.one);
    with_twin_two.insert(twin.two);
  }
  account.explained = std::min(with_twin_one.size(), with_twin_two.size());
  account.across = std::min(fewer_of_two_directions(one.walls, with_twin_one),
                            fewer_of_two_directions(two.walls, with_twin_two));
  account.of_two = fates(two.walls, with_twin_two, one_from_two, one.free, options);
  const std::vector<WallFate> of_one =
      fates(one.walls, with_twin_one, inverse(one_from_two), two.free, options);
  account.contradicted = beyond_own(account.of_two, two.own_share) + beyond_own(of_one, one.own_share);
  account.beyond = std::min(count(account.of_two, WallFate::beyond), count(of_one, WallFate::beyond));
  return account;
}

bool is_same_placing(const Pose& a, const Pose& b, const Eigen::Vector2d& middle,
                     const MergingOptions& options, double times) {
  return (a * middle - b * middle).norm() < times * options.same_m &&
         std::abs(wrap_angle(a.yaw - b.yaw)) < times * options.same_rad;
}

}  // namespace isthmus
