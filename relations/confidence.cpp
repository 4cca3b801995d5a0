#include "relations/confidence.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "relations/information.hpp"

namespace isthmus {
namespace {

/// Worse than 100 m or 100 rad is not determined: undetermined directions stand with 1e8 where they arise,
/// and what hangs by them moves with them.
constexpr double max_variance = 1e4;

/// Half the width of a 95 % interval of a normal distribution, in standard deviations.
constexpr double sigmas_of_95_percent = 1.96;

bool determined(const Eigen::Matrix3d& covariance) {
  return covariance.allFinite() && covariance.diagonal().maxCoeff() < max_variance;
}

/// The covariance of a pose of the plane with a held, turned into a's axes.
Eigen::Matrix3d in_frame_of(const Pose& a, const Eigen::Matrix3d& covariance) {
  Eigen::Matrix3d a_from_plane = Eigen::Matrix3d::Identity();
  a_from_plane.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(-a.yaw).toRotationMatrix();
  return a_from_plane * covariance * a_from_plane.transpose();
}

}  // namespace

std::map<PatchId, Eigen::Matrix3d> local_relative_covariances(
    const RelationGraph& graph, std::span<const Pose> poses, PatchId a, std::size_t max_patches,
    const std::function<bool(const Relation&)>& counts) {
  std::map<PatchId, Eigen::Matrix3d> found;
  const std::vector<PatchId> patches = graph.nearest_in_graph(a, max_patches);
  if (patches.size() < 2) return found;
  BlockCholesky<3> information = reduced_information(graph, poses, patches, counts);
  information.factor();
  const std::vector<Eigen::Matrix3d> covariances = information.inverse_diagonal();
  for (std::size_t i = 0; i < covariances.size(); ++i)
    if (determined(covariances[i]))
      found.emplace(patches[i + 1], in_frame_of(poses[index(a)], covariances[i]));
  return found;
}

std::optional<Eigen::Matrix3d> local_relative_covariance(const RelationGraph& graph,
                                                         std::span<const Pose> poses, PatchId a, PatchId b,
                                                         std::size_t max_patches) {
  if (a == b) return Eigen::Matrix3d::Zero();
  std::vector<PatchId> patches = graph.nearest_in_graph(a, max_patches / 2);
  for (const PatchId patch : graph.nearest_in_graph(b, max_patches / 2))
    if (std::find(patches.begin(), patches.end(), patch) == patches.end()) patches.push_back(patch);
  BlockCholesky<3> information = reduced_information(graph, poses, patches);
  information.factor();
  const auto row = static_cast<int>(std::find(patches.begin(), patches.end(), b) - patches.begin()) - 1;
  const Eigen::Matrix3d covariance = information.inverse_diagonal(row);
  if (!determined(covariance)) return std::nullopt;
  return in_frame_of(poses[index(a)], covariance);
}

std::vector<Eigen::Matrix3d> exact_relative_covariances(const RelationGraph& graph,
                                                        std::span<const Pose> poses, PatchId a,
                                                        std::span<const PatchId> others) {
  std::vector<PatchId> patches{a};
  for (const PatchId patch : graph.patches_of(graph.island(a)))
    if (patch != a) patches.push_back(patch);
  std::vector<int> row(graph.patch_count(), -1);
  for (std::size_t i = 1; i < patches.size(); ++i) row[index(patches[i])] = static_cast<int>(i) - 1;

  BlockCholesky<3> information = reduced_information(graph, poses, patches);
  information.factor();
  if (!information.positive_definite()) return {};
  std::vector<Eigen::Matrix3d> found;
  for (const PatchId other : others) {
    if (other == a) {
      found.push_back(Eigen::Matrix3d::Zero());
      continue;
    }
    if (row[index(other)] < 0) return {};
    found.push_back(in_frame_of(poses[index(a)], information.inverse_diagonal(row[index(other)])));
  }
  return found;
}

IslandCovariances::IslandCovariances(const RelationGraph& graph, std::span<const Pose> poses, IslandId island)
    : poses_(poses.begin(), poses.end()),
      row_(graph.patch_count(), -1),
      information_(reduced_information(graph, poses, graph.patches_of(island))) {
  const std::vector<PatchId> patches = graph.patches_of(island);
  for (std::size_t i = 1; i < patches.size(); ++i) row_[index(patches[i])] = static_cast<int>(i) - 1;
  information_.factor();
}

// Of the patches' poses in the plane, by the Jacobians of b's pose in a's frame.
std::vector<Eigen::Matrix3d> IslandCovariances::relative_to(PatchId a,
                                                            std::span<const PatchId> others) const {
  if (!information_.positive_definite()) return {};
  const int row_of_a = row_[index(a)];
  const std::vector<Eigen::Matrix3d> with_a =
      row_of_a < 0 ? std::vector<Eigen::Matrix3d>(row_.size(), Eigen::Matrix3d::Zero())
                   : information_.inverse_column(row_of_a);
  const auto own = [&](int row) -> Eigen::Matrix3d {
    return row < 0 ? Eigen::Matrix3d::Zero() : information_.inverse_diagonal(row);
  };
  const Eigen::Matrix3d of_a = own(row_of_a);
  std::vector<Eigen::Matrix3d> found;
  for (const PatchId b : others) {
    const int row_of_b = row_[index(b)];
    const OminusJacobians jacobians = ominus_jacobians(poses_[index(b)], poses_[index(a)]);
    Eigen::Matrix3d cross = Eigen::Matrix3d::Zero();
    if (row_of_b >= 0)
      cross = jacobians.by_q * with_a[static_cast<std::size_t>(row_of_b)] * jacobians.by_pi.transpose();
    found.push_back(jacobians.by_pi * of_a * jacobians.by_pi.transpose() + cross + cross.transpose() +
                    jacobians.by_q * own(row_of_b) * jacobians.by_q.transpose());
  }
  return found;
}

bool well_determined(const Eigen::Matrix3d& relative_covariance, const ConfidenceThreshold& threshold) {
  const Eigen::Matrix2d position = relative_covariance.topLeftCorner<2, 2>();
  const double middle = 0.5 * position.trace();
  const double half_difference = std::hypot(0.5 * (position(0, 0) - position(1, 1)), position(0, 1));
  const double longest = std::sqrt(std::max(0.0, middle + half_difference));
  const double sigma_yaw = std::sqrt(std::max(0.0, relative_covariance(2, 2)));
  return sigmas_of_95_percent * longest <= threshold.position_m &&
         sigmas_of_95_percent * sigma_yaw <= threshold.yaw_rad;
}

}  // namespace isthmus
