#include "scanmatch/match.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

// A beam's end with the sums that one beam contributes, over the patches it is paired with.
struct Beam {
  int point = 0;
  Eigen::Vector2d position;  // in the robot's frame
  Eigen::Vector2d normal;    // in the robot's frame; zero: none
};

struct NormalEquations {
  Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  double weight_sum = 0;   // of the beams' best weights
  double squared_sum = 0;  // weighted squared distances
  double squared_weight = 0;
  int inliers = 0;
  int paired = 0;
};

std::vector<Beam> choose_beams(std::span<const ScanPoint> points, int most) {
  std::vector<Beam> beams;
  beams.reserve(std::min<std::size_t>(points.size(), static_cast<std::size_t>(most) * 2));
  const int stride = std::max(1, static_cast<int>(points.size() + static_cast<std::size_t>(most) / 2) / most);
  for (int i = stride / 2; i < static_cast<int>(points.size()); i += stride) {
    const ScanPoint& point = points[static_cast<std::size_t>(i)];
    beams.push_back({i, point.position, point.normal});
  }
  return beams;
}

// Geman-McClure's weight of a squared distance: like Cauchy's near zero, falling faster far out.
double robust_weight(double squared, double kernel) {
  const double ratio = 1 + squared / (kernel * kernel);
  return 1 / (ratio * ratio);
}

class Matcher {
 public:
  Matcher(const LocalMap& map, std::span<const ScanPoint> points, const MatchOptions& options)
      : map_(map), options_(options), beams_(choose_beams(points, options.max_points)) {
    for (const LocalPatch& local : map.patches) {
      patch_from_local_.push_back(inverse(local.local_from_patch));
    }
  }

  // Pairs at a pose and sums the normal equations by (x, y, yaw) of the pose in the local frame.
  NormalEquations linearise(const Pose& pose, double kernel, std::vector<Pair>* pairs) const {
    NormalEquations sums;
    struct Hit {
      Eigen::Vector3d jacobian;
      double residual;
      double weight;
      int patch;
      int line;
    };
    std::vector<Hit> hits(map_.patches.size());
    const double min_cosine = std::cos(options_.max_normal_angle_rad);
    const double gate = std::max(0.1, 3 * kernel);
    struct Frame {
      double c, s, x, y;  // patch_from_robot
      double ux, uy;      // patch axes of the local x axis' direction
      double vx, vy;
    };
    std::vector<Frame> frames(map_.patches.size());
    for (std::size_t k = 0; k < frames.size(); ++k) {
      const Pose patch_from_robot = patch_from_local_[k] * pose;
      const double yaw = patch_from_local_[k].yaw;
      frames[k] = {std::cos(patch_from_robot.yaw),
                   std::sin(patch_from_robot.yaw),
                   patch_from_robot.x,
                   patch_from_robot.y,
                   std::cos(yaw),
                   std::sin(yaw),
                   -std::sin(yaw),
                   std::cos(yaw)};
    }
    for (const Beam& beam : beams_) {
      std::size_t count = 0;
      double best = 0;
      double total = 0;
      for (std::size_t k = 0; k < frames.size(); ++k) {
        const Frame& f = frames[k];
        const Eigen::Vector2d arm(f.c * beam.position.x() - f.s * beam.position.y(),
                                  f.s * beam.position.x() + f.c * beam.position.y());
        const Eigen::Vector2d at(arm.x() + f.x, arm.y() + f.y);
        const Patch& patch = *map_.patches[k].patch;
        const int line = patch.index.nearest(at);
        if (line < 0) continue;
        const ScanPoint& target = patch.points[static_cast<std::size_t>(line)];
        const Eigen::Vector2d offset = at - target.position;
        const double residual = target.normal.dot(offset);
        if (std::abs(residual) > gate) continue;
        const Eigen::Vector2d normal(f.c * beam.normal.x() - f.s * beam.normal.y(),
                                     f.s * beam.normal.x() + f.c * beam.normal.y());
        if (beam.normal.squaredNorm() > 0.5 && normal.dot(target.normal) < min_cosine) continue;
        const double weight = robust_weight(residual * residual, kernel);
        hits[count++] = {{target.normal.x() * f.ux + target.normal.y() * f.uy,
                          target.normal.x() * f.vx + target.normal.y() * f.vy,
                          target.normal.y() * arm.x() - target.normal.x() * arm.y()},
                         residual,
                         weight,
                         static_cast<int>(k),
                         line};
        best = std::max(best, weight);
        total += weight;
      }
      if (count == 0) continue;
      ++sums.paired;
      sums.weight_sum += best;
      const double share = 1.0 / static_cast<double>(count);
      double inlying = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const Hit& hit = hits[i];
        const double weight = hit.weight * share;
        sums.h.noalias() += weight * hit.jacobian * hit.jacobian.transpose();
        sums.g.noalias() += weight * hit.residual * hit.jacobian;
        sums.squared_sum += weight * hit.residual * hit.residual;
        sums.squared_weight += weight;
        inlying = std::max(inlying, std::abs(hit.residual) < options_.kernel_m ? 1.0 : 0.0);
        if (pairs) pairs->push_back({hit.patch, beam.point, hit.line, weight});
      }
      sums.inliers += inlying > 0 ? 1 : 0;
    }
    return sums;
  }

  int beams() const { return static_cast<int>(beams_.size()); }

 private:
  const LocalMap& map_;
  const MatchOptions& options_;
  std::vector<Beam> beams_;
  std::vector<Pose> patch_from_local_;
};

// How the beams' information is spread over the plane's directions, the yaw left free.
struct Directions {
  Eigen::Matrix2d axes = Eigen::Matrix2d::Identity();
  Eigen::Vector2d share = Eigen::Vector2d::Zero();  // of each axis, per unit of weight, ascending
};

Directions directions_of(const NormalEquations& sums) {
  const double yaw_information = std::max(sums.h(2, 2), 1e-12);
  const Eigen::Matrix2d plane = sums.h.topLeftCorner<2, 2>() - sums.h.topRightCorner<2, 1>() *
                                                                   sums.h.bottomLeftCorner<1, 2>() /
                                                                   yaw_information;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver;
  solver.computeDirect(plane);
  return {solver.eigenvectors(), (solver.eigenvalues() / std::max(sums.squared_weight, 1e-12)).cwiseMax(0.0)};
}

Eigen::Matrix2d direction_trust(const Directions& directions, double thin) {
  Eigen::Vector2d trust;
  for (int i = 0; i < 2; ++i) {
    const double squared = directions.share(i) * directions.share(i);
    trust(i) = std::sqrt(squared / (squared + thin * thin + 1e-12));
  }
  return directions.axes * trust.asDiagonal() * directions.axes.transpose();
}

MatchQuality quality_of(const NormalEquations& sums, const Directions& directions, int beams, double thin) {
  MatchQuality quality;
  quality.beams = beams;
  quality.paired_beams = sums.paired;
  if (beams == 0 || sums.paired == 0) return quality;
  quality.score = sums.weight_sum / beams;
  quality.inlier_share = static_cast<double>(sums.inliers) / beams;
  quality.rms_m = std::sqrt(sums.squared_sum / std::max(sums.squared_weight, 1e-12));
  quality.weakest_direction = directions.share(0);
  quality.degenerate = directions.share(0) < thin;
  return quality;
}

}  // namespace

Match match_scan(const LocalMap& local_map, std::span<const ScanPoint> points, const Prediction& prediction,
                 const MatchOptions& options) {
  Match match;
  match.local_from_robot = prediction.local_from_robot;
  const Matcher matcher(local_map, points, options);
  Pose pose = prediction.local_from_robot;
  double kernel = std::max(options.start_kernel_m, options.kernel_m);
  const double information_of_unit = 1 / (options.sigma_m * options.sigma_m);
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    const NormalEquations sums = matcher.linearise(pose, kernel, nullptr);
    if (sums.paired < options.min_pairs) return match;
    Eigen::Matrix3d trust = Eigen::Matrix3d::Identity();
    trust.topLeftCorner<2, 2>() = direction_trust(directions_of(sums), options.thin_direction);
    Eigen::Vector3d innovation = to_vector(pose) - to_vector(prediction.local_from_robot);
    innovation.z() = wrap_angle(innovation.z());
    Eigen::Matrix3d h = information_of_unit * (trust * sums.h * trust) + prediction.information;
    const Eigen::Vector3d g = information_of_unit * (trust * sums.g) + prediction.information * innovation;
    h.diagonal() += Eigen::Vector3d(1e-3, 1e-3, 1e-3);
    Eigen::Vector3d step = -h.ldlt().solve(g);
    if (!step.allFinite()) return match;
    const double length = step.head<2>().norm();
    if (length > 0.3) step *= 0.3 / length;
    pose = to_pose(to_vector(pose) + step);
    const bool settled = length < 5e-4 && std::abs(step.z()) < 2e-4;
    if (settled && kernel <= options.kernel_m) break;
    kernel = std::max(options.kernel_m, settled ? options.kernel_m : 0.6 * kernel);
  }
  const NormalEquations sums = matcher.linearise(pose, options.kernel_m, &match.pairs);
  match.local_from_robot = pose;
  const Directions directions = directions_of(sums);
  match.direction_trust = direction_trust(directions, options.thin_direction);
  Eigen::Matrix3d trust = Eigen::Matrix3d::Identity();
  trust.topLeftCorner<2, 2>() = match.direction_trust;
  match.beam_information = information_of_unit * (trust * sums.h * trust);
  match.quality = quality_of(sums, directions, matcher.beams(), options.thin_direction);
  match.ok = sums.paired >= options.min_pairs;
  return match;
}

}  // namespace isthmus
