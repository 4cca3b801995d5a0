#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "server/features/feature_filter.hpp"

namespace isthmus::testing {

/// Landmarks around a robot that drives round and round, its odometry and sightings erring as it tells.
///
///      landmarks on a grid of 4 m; the way: a circle of radius 10 m, a step each 0.5 m
struct LandmarkWorld {
  std::vector<Eigen::Vector2d> landmarks;
  double step_m = 0.5;
  double radius_m = 10;
  double reach_m = 6;
  double landmark_sigma_m = 0.1;
  Eigen::Vector3d odometry_sigma{0.02, 0.02, 0.02};

  LandmarkWorld() {
    for (int x = -4; x <= 4; ++x)
      for (int y = -2; y <= 6; ++y) landmarks.emplace_back(4.0 * x, 4.0 * y);
  }

  Pose true_step() const { return {step_m, 0, step_m / radius_m}; }
  Eigen::Matrix3d odometry_covariance() const { return odometry_sigma.cwiseAbs2().asDiagonal(); }

  Pose odometry(std::mt19937& random) const {
    std::normal_distribution<double> normal;
    const Pose step = true_step();
    return {step.x + odometry_sigma.x() * normal(random), step.y + odometry_sigma.y() * normal(random),
            step.yaw + odometry_sigma.z() * normal(random)};
  }

  struct Seen {
    std::vector<ObservedFeature> features;
    std::vector<int> which;
  };
  Seen look(const Pose& truth, std::mt19937& random) const {
    std::normal_distribution<double> normal(0, landmark_sigma_m);
    Seen seen;
    for (std::size_t i = 0; i < landmarks.size(); ++i) {
      const Eigen::Vector2d there = inverse(truth) * landmarks[i];
      if (there.norm() > reach_m || there.x() < 0) continue;
      const Eigen::Vector2d noise(normal(random), normal(random));
      seen.features.push_back(
          {point_feature(there + noise), landmark_sigma_m * landmark_sigma_m * LocalMatrix::Identity(2, 2)});
      seen.which.push_back(static_cast<int>(i));
    }
    return seen;
  }
};

}  // namespace isthmus::testing
