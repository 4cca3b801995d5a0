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

// The direction of the plane that a match determines least, and how surely its relations say so.
struct Weakest {
  Eigen::Matrix2d axes;  // it, and the one across
  double variance_m2 = 0;
};

Weakest weakest_of(const Match& match, double sigma_m, const MatchOptions& options) {
  Eigen::Vector2d information;
  const Eigen::Matrix2d axes = axes_of(match.beam_information, &information);
  return {axes, sigma_m * sigma_m / (options.sigma_m * options.sigma_m * information(0))};
}

void trust_along(Match& match, const Weakest& weakest, double factor) {
  match.direction_trust = weakest.axes * Eigen::Vector2d(factor, 1).asDiagonal() * weakest.axes.transpose() *
                          match.direction_trust;
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

void widen(Match& match, double weak_sigma_m, double sigma_m, const MatchOptions& options) {
  const Weakest weakest = weakest_of(match, sigma_m, options);
  const double variance = weakest.variance_m2;
  trust_along(match, weakest, std::sqrt(variance / (variance + weak_sigma_m * weak_sigma_m)));
}

void believe_profile(Match& match, double weak_sigma_m, double sigma_m, const MatchOptions& options,
                     const WeakDirectionOptions& weak_direction_options) {
  const Weakest weakest = weakest_of(match, sigma_m, options);
  const double told_apart = std::min(weakest.variance_m2, std::pow(weak_direction_options.step_m, 2));
  const double sure = std::sqrt(weakest.variance_m2 / (told_apart + weak_sigma_m * weak_sigma_m));
  const Eigen::Vector2d along = weakest.axes.col(0);
  const double now = along.dot(match.direction_trust * along);
  trust_along(match, weakest, std::min(sure, std::max(1.0, 1 / std::max(now, 1e-9))));
}

}  // namespace isthmus
