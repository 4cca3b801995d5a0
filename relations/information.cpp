#include "relations/information.hpp"

namespace isthmus {
namespace {

std::size_t index(PatchId id) { return static_cast<std::size_t>(id.value); }

/// A relation among the patches at hand, its ends as places in the list.
struct Link {
  const Relation* relation;
  int a;
  int b;
};

std::vector<Link> links_among(const RelationGraph& graph, std::span<const PatchId> patches) {
  std::vector<int> place(graph.patch_count(), -1);
  for (std::size_t i = 0; i < patches.size(); ++i) place[index(patches[i])] = static_cast<int>(i);
  std::vector<Link> links;
  for (const PatchId patch : patches) {
    for (const RelationId id : graph.of(patch)) {
      const Relation* relation = graph.find(id);
      const int other = place[index(relation->b)];
      if (relation->a == patch && other >= 0) links.push_back({relation, place[index(patch)], other});
    }
  }
  return links;
}

}  // namespace

BlockCholesky<3> reduced_information(const RelationGraph& graph, std::span<const Pose> poses,
                                     std::span<const PatchId> patches,
                                     const std::function<bool(const Relation&)>& counts) {
  std::vector<Link> links = links_among(graph, patches);
  if (counts) std::erase_if(links, [&](const Link& link) { return !counts(*link.relation); });
  std::vector<std::pair<int, int>> pairs;
  pairs.reserve(links.size());
  for (const Link& link : links)
    if (link.a > 0 && link.b > 0) pairs.emplace_back(link.a - 1, link.b - 1);

  BlockCholesky<3> matrix(static_cast<int>(patches.size()) - 1, pairs);
  for (const Link& link : links) {
    const Pose& pose_a = poses[index(link.relation->a)];
    const Pose& pose_b = poses[index(link.relation->b)];
    const Eigen::Matrix3d weight = information(*link.relation, ominus(pose_b, pose_a));
    const OminusJacobians jacobians = ominus_jacobians(pose_b, pose_a);
    const Eigen::Matrix3d weighted_a = weight * jacobians.by_pi;
    const Eigen::Matrix3d weighted_b = weight * jacobians.by_q;
    if (link.a > 0) matrix.add_diagonal(link.a - 1, jacobians.by_pi.transpose() * weighted_a);
    if (link.b > 0) matrix.add_diagonal(link.b - 1, jacobians.by_q.transpose() * weighted_b);
    if (link.a > 0 && link.b > 0)
      matrix.add(link.a - 1, link.b - 1, jacobians.by_pi.transpose() * weighted_b);
  }
  return matrix;
}

}  // namespace isthmus
