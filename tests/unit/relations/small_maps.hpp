#pragma once

#include <Eigen/Dense>
#include <numbers>
#include <random>
#include <set>
#include <vector>

#include "relations/graph.hpp"

namespace isthmus::small_maps {

inline double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random()) / 4294967295.0;
}

inline Pose random_pose(std::mt19937& random, double reach_m = 5) {
  return {uniform(random, -reach_m, reach_m), uniform(random, -reach_m, reach_m),
          uniform(random, -std::numbers::pi, std::numbers::pi)};
}

inline Eigen::Vector2d random_point(std::mt19937& random, double reach_m = 5) {
  return {uniform(random, -reach_m, reach_m), uniform(random, -reach_m, reach_m)};
}

inline Eigen::Matrix3d random_information(std::mt19937& random) {
  Eigen::Matrix3d root;
  for (int i = 0; i < 9; ++i) root(i) = uniform(random, -3, 3);
  return root * root.transpose() + Eigen::Vector3d(4, 5, 50).asDiagonal().toDenseMatrix();
}

/// One correspondence, kept beside the form that it went into.
struct PointOnLine {
  Eigen::Vector2d point_b, line_point_a, line_normal_a;
  double sigma_m;

  double residual(const Pose& a_from_b) const {
    return line_normal_a.dot(a_from_b * point_b - line_point_a) / sigma_m;
  }
};

/// Points of b on walls of a, at the true pose up to `noise_m` across the wall. Walls along `wall_yaws`.
inline std::vector<PointOnLine> points_on_walls(std::mt19937& random, const Pose& a_from_b, int count,
                                                const std::vector<double>& wall_yaws, double noise_m) {
  std::vector<PointOnLine> found;
  for (int i = 0; i < count; ++i) {
    const double normal_yaw =
        wall_yaws[static_cast<std::size_t>(i) % wall_yaws.size()] + std::numbers::pi / 2;
    const Eigen::Vector2d normal(std::cos(normal_yaw), std::sin(normal_yaw));
    const Eigen::Vector2d along(-normal.y(), normal.x());
    const Eigen::Vector2d point_b = random_point(random);
    const Eigen::Vector2d on_line = a_from_b * point_b + uniform(random, -1, 1) * along;
    found.push_back(
        {point_b, on_line + uniform(random, -noise_m, noise_m) * normal, normal, uniform(random, 0.02, 0.1)});
  }
  return found;
}

inline Correspondences correspondences(const std::vector<PointOnLine>& points) {
  QuadraticFormBuilder builder;
  for (const PointOnLine& p : points)
    builder.point_on_line(p.point_b, p.line_point_a, p.line_normal_a, p.sigma_m);
  return {builder.build(), builder.rows(), {}};
}

inline Relation relation(int a, int b, Measurement measurement) {
  Relation made;
  made.a = PatchId{a};
  made.b = PatchId{b};
  made.measurement = std::move(measurement);
  return made;
}

struct SmallMap {
  RelationGraph graph;
  std::vector<Pose> truth;

  explicit SmallMap(int patches) : truth(static_cast<std::size_t>(patches)) {
    for (int i = 0; i < patches; ++i) graph.add_patch(PatchId{i});
  }
  const Pose& pose(int i) const { return truth[static_cast<std::size_t>(i)]; }
  Pose relative(int a, int b) const { return ominus(pose(b), pose(a)); }
};

/// A walk of random steps with odometry between neighbours and `chords` more relations of every kind; noise 0
/// makes every measurement exact.
///
///     0 --- 1 --- 2 --- ... --- n-1
///      \_________/    chords
inline SmallMap random_map(std::mt19937& random, int patches, int chords, double noise) {
  SmallMap map(patches);
  for (int i = 1; i < patches; ++i)
    map.truth[static_cast<std::size_t>(i)] =
        map.pose(i - 1) *
        Pose{uniform(random, 0.3, 1.2), uniform(random, -0.3, 0.3), uniform(random, -0.6, 0.6)};
  const auto disturbed = [&](const Pose& pose) {
    return pose * Pose{noise * uniform(random, -1, 1), noise * uniform(random, -1, 1),
                       0.3 * noise * uniform(random, -1, 1)};
  };
  for (int i = 1; i < patches; ++i)
    map.graph.add(
        relation(i - 1, i, RelativePose{disturbed(map.relative(i - 1, i)), random_information(random)}));
  for (int i = 0; i < chords; ++i) {
    const int a = static_cast<int>(random() % static_cast<unsigned>(patches));
    const int b = static_cast<int>(random() % static_cast<unsigned>(patches));
    if (a == b) continue;
    const Pose a_from_b = map.relative(a, b);
    const Eigen::Vector2d p = random_point(random);
    switch (i % 4) {
      case 0: {
        const Range range{random_point(random), p, 0, 0.1};
        Range measured = range;
        measured.range_m = (a_from_b * p - range.point_a).norm() + noise * uniform(random, -1, 1);
        map.graph.add(relation(a, b, measured));
        break;
      }
      case 1: {
        Bearing measured{random_pose(random), p, 0, 0.05};
        const Eigen::Vector2d seen = inverse(measured.a_from_observer) * (a_from_b * p);
        measured.bearing_rad =
            wrap_angle(std::atan2(seen.y(), seen.x()) + 0.1 * noise * uniform(random, -1, 1));
        map.graph.add(relation(a, b, measured));
        break;
      }
      default: {
        Relation walls =
            relation(a, b, correspondences(points_on_walls(random, a_from_b, 20, {0.1, 1.7}, noise)));
        if (i % 8 == 7) walls.robust_scale = 3;
        map.graph.add(walls);
      }
    }
  }
  return map;
}

inline std::vector<Pose> disturbed(std::mt19937& random, std::vector<Pose> poses, double by) {
  for (std::size_t i = 1; i < poses.size(); ++i)
    poses[i] = poses[i] * Pose{by * uniform(random, -1, 1), by * uniform(random, -1, 1),
                               0.3 * by * uniform(random, -1, 1)};
  return poses;
}

/// The whole information of eq. 9, dense, none held; the oracle for everything sparse.
inline Eigen::MatrixXd dense_information(const RelationGraph& graph, const std::vector<Pose>& poses) {
  const auto size = static_cast<Eigen::Index>(3 * poses.size());
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(size, size);
  for (const auto& [id, relation] : graph.relations()) {
    const Pose& pose_a = poses[static_cast<std::size_t>(relation.a.value)];
    const Pose& pose_b = poses[static_cast<std::size_t>(relation.b.value)];
    Eigen::MatrixXd by_poses = Eigen::MatrixXd::Zero(3, size);
    const OminusJacobians jacobians = ominus_jacobians(pose_b, pose_a);
    by_poses.middleCols<3>(3 * relation.a.value) = jacobians.by_pi;
    by_poses.middleCols<3>(3 * relation.b.value) = jacobians.by_q;
    dense += by_poses.transpose() * information(relation, ominus(pose_b, pose_a)) * by_poses;
  }
  return dense;
}

/// The covariance with patch `held` held, its rows and columns zero.
inline Eigen::MatrixXd dense_covariance(const Eigen::MatrixXd& information, int held) {
  std::vector<int> kept;
  for (int i = 0; i < static_cast<int>(information.rows()); ++i)
    if (i / 3 != held) kept.push_back(i);
  const Eigen::MatrixXd reduced = information(kept, kept);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(information.rows(), information.cols());
  const Eigen::MatrixXd inverse =
      reduced.ldlt().solve(Eigen::MatrixXd::Identity(reduced.rows(), reduced.cols()));
  covariance(kept, kept) = inverse;
  return covariance;
}

/// Σ_b|a = Σ_bb − T Σ_ab − Σ_ba Tᵀ + T Σ_aa Tᵀ, T = G_b G_a⁻¹, from a covariance with any patch held; in a's
/// axes.
inline Eigen::Matrix3d relative_covariance(const Eigen::MatrixXd& covariance, const std::vector<Pose>& poses,
                                           int a, int b) {
  const auto rigid = [&](int i) {
    const Pose& pose = poses[static_cast<std::size_t>(i)];
    Eigen::Matrix3d g = Eigen::Matrix3d::Identity();
    g(0, 2) = -pose.y;
    g(1, 2) = pose.x;
    return g;
  };
  const auto block = [&](int i, int j) { return Eigen::Matrix3d(covariance.block<3, 3>(3 * i, 3 * j)); };
  const Eigen::Matrix3d t = rigid(b) * rigid(a).inverse();
  const Eigen::Matrix3d plane =
      block(b, b) - t * block(a, b) - block(b, a) * t.transpose() + t * block(a, a) * t.transpose();
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(-poses[static_cast<std::size_t>(a)].yaw).toRotationMatrix();
  return turn * plane * turn.transpose();
}

inline double distance(const Pose& p, const Pose& q) {
  return std::hypot(p.x - q.x, p.y - q.y) + std::abs(wrap_angle(p.yaw - q.yaw));
}

}  // namespace isthmus::small_maps
