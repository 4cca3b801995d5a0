#include "relations/information.hpp"

namespace isthmus {
namespace {

/// The relations between two patches, their ends as places in the list, and what they say together.
struct Link {
  int a;
  int b;
  Pose a_from_b;
  Eigen::Matrix3d weight = Eigen::Matrix3d::Zero();  ///< information by the (x, y, yaw) of a_from_b
};

std::vector<Link> links_among(const RelationGraph& graph, std::span<const Pose> poses,
                              std::span<const PatchId> patches,
                              const std::function<bool(const Relation&)>& counts) {
  std::vector<int> place(graph.patch_count(), -1);
  for (std::size_t i = 0; i < patches.size(); ++i) place[index(patches[i])] = static_cast<int>(i);
  std::vector<Link> links;
  std::vector<int> link_to(patches.size(), -1);  // of the patch at hand, by place of the other end
  for (std::size_t a = 0; a < patches.size(); ++a) {
    const std::size_t first = links.size();
    for (const RelationId id : graph.of(patches[a])) {
      const Relation& relation = *graph.find(id);
      const int b = place[index(relation.b)];
      if (relation.a != patches[a] || b < 0 || (counts && !counts(relation))) continue;
      int& at = link_to[static_cast<std::size_t>(b)];
      if (at < 0) {
        at = static_cast<int>(links.size());
        const Pose a_from_b = ominus(poses[index(relation.b)], poses[index(relation.a)]);
        links.push_back({static_cast<int>(a), b, a_from_b});
      }
      Link& link = links[static_cast<std::size_t>(at)];
      link.weight += information(relation, link.a_from_b);
    }
    for (std::size_t i = first; i < links.size(); ++i) link_to[static_cast<std::size_t>(links[i].b)] = -1;
  }
  return links;
}

}  // namespace

BlockCholesky<3> reduced_information(const RelationGraph& graph, std::span<const Pose> poses,
                                     std::span<const PatchId> patches,
                                     const std::function<bool(const Relation&)>& counts) {
  const std::vector<Link> links = links_among(graph, poses, patches, counts);
  std::vector<std::pair<int, int>> pairs;
  pairs.reserve(links.size());
  for (const Link& link : links)
    if (link.a > 0 && link.b > 0) pairs.emplace_back(link.a - 1, link.b - 1);

  BlockCholesky<3> matrix(static_cast<int>(patches.size()) - 1, pairs);
  for (const Link& link : links) {
    const Pose& pose_a = poses[index(patches[static_cast<std::size_t>(link.a)])];
    const Pose& pose_b = poses[index(patches[static_cast<std::size_t>(link.b)])];
    const OminusJacobians jacobians = ominus_jacobians(pose_b, pose_a);
    const Eigen::Matrix3d weighted_a = link.weight * jacobians.by_pi;
    const Eigen::Matrix3d weighted_b = link.weight * jacobians.by_q;
    if (link.a > 0) matrix.add_diagonal(link.a - 1, jacobians.by_pi.transpose() * weighted_a);
    if (link.b > 0) matrix.add_diagonal(link.b - 1, jacobians.by_q.transpose() * weighted_b);
    if (link.a > 0 && link.b > 0)
      matrix.add(link.a - 1, link.b - 1, jacobians.by_pi.transpose() * weighted_b);
  }
  return matrix;
}

}  // namespace isthmus
