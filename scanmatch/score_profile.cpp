#include "scanmatch/score_profile.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace isthmus {
namespace {

// The axes of what the beams say of the plane, the yaw left free: least determined first.
Eigen::Matrix2d axes_of(const Eigen::Matrix3d& information, Eigen::Vector2d* eigenvalues) {
  const double yaw_information = std::max(information(2, 2), 1e-12);
  const Eigen::Matrix2d plane = information.topLeftCorner<2, 2>() - information.topRightCorner<2, 1>() *
                                                                        information.bottomLeftCorner<1, 2>() /
                                                                        yaw_information;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver;
  solver.computeDirect(plane);
  *eigenvalues = solver.eigenvalues().cwiseMax(1e-9);
  return solver.eigenvectors();
}

}  // namespace

double sigma_along_weak_direction(const LocalMap& local_map, std::span<const ScanPoint> points,
                                  const Match& match, double half_width_m, const MatchOptions& options,
                                  const WeakDirectionOptions& weak_direction_options) {
  const double step_m = weak_direction_options.step_m;
  Eigen::Vector2d unused;
  const Eigen::Vector2d weakest = axes_of(match.beam_information, &unused).col(0);
  MatchOptions coarse = options;
  coarse.start_kernel_m = weak_direction_options.start_kernels * options.kernel_m;
  coarse.max_points = std::min(options.max_points, weak_direction_options.max_points);
  const auto score_at = [&](double along_m) {
    Prediction prediction{match.local_from_robot, Eigen::Matrix3d::Zero()};
    prediction.local_from_robot.x += along_m * weakest.x();
    prediction.local_from_robot.y += along_m * weakest.y();
    prediction.information.topLeftCorner<2, 2>() =
        weak_direction_options.held_information * weakest * weakest.transpose();
    const Match held_match = match_scan(local_map, points, prediction, coarse);
    return held_match.ok ? held_match.quality.score : 0.0;
  };
  const double best = std::max(score_at(0), 1e-6);
  double weights = 1;
  double moment = 0;
  for (const double side : {-1.0, 1.0}) {
    for (double along_m = step_m; along_m <= half_width_m; along_m += step_m) {
      const double weight =
          std::exp(-weak_direction_options.sharpness * std::max(0.0, 1 - score_at(side * along_m) / best));
      weights += weight;
      moment += weight * along_m * along_m;
    }
  }
  return std::sqrt(moment / weights);
}

void believe_profile(Match& match, double weak_sigma_m, double sigma_m, const MatchOptions& options,
                     const WeakDirectionOptions& weak_direction_options) {
  Eigen::Vector2d information;
  const Eigen::Matrix2d axes = axes_of(match.beam_information, &information);
  const double variance = sigma_m * sigma_m / (options.sigma_m * options.sigma_m * information(0));
  const double told_apart = std::min(variance, std::pow(weak_direction_options.step_m, 2));
  const double sure = std::sqrt(variance / (told_apart + weak_sigma_m * weak_sigma_m));
  const double now = axes.col(0).dot(match.direction_trust * axes.col(0));
  const double trust = std::min(sure, std::max(1.0, 1 / std::max(now, 1e-9)));
  match.direction_trust =
      axes * Eigen::Vector2d(trust, 1).asDiagonal() * axes.transpose() * match.direction_trust;
}

}  // namespace isthmus
