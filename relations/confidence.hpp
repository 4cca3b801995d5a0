#pragma once

#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "relations/block_cholesky.hpp"
#include "relations/graph.hpp"

namespace isthmus {

/// Relative Fisher confidence (Howard et al. 2006, III-C; eqs. 9, 10, 12): how well patch b is determined
/// with respect to patch a, as the covariance of (x, y, yaw) of a_from_b, in a's own frame. Information is
/// Gauss-Newton's. `poses` is indexed by patch id.

/// For localisation: from the information of the at most `max_patches` patches nearest to `a` in the graph, a
/// held. At the same poses and weights it never says less than the exact covariance. Holds every patch of the
/// sub-graph but `a` that is determined with respect to it. Relations that `counts` says no to are left out.
std::map<PatchId, Eigen::Matrix3d> local_relative_covariances(
    const RelationGraph& graph, std::span<const Pose> poses, PatchId a, std::size_t max_patches = 200,
    const std::function<bool(const Relation&)>& counts = {});

/// The same of one patch b, from the at most `max_patches` patches nearest to a or to b. Nothing where those
/// do not determine it.
std::optional<Eigen::Matrix3d> local_relative_covariance(const RelationGraph& graph,
                                                         std::span<const Pose> poses, PatchId a, PatchId b,
                                                         std::size_t max_patches);

/// For reports and operators, from the whole island: the covariance of each of `others` (on a's island)
/// relative to a; one factorisation for all. A patch equal to `a` gets zero. It does
/// not depend on a gauge, as relations are relative: holding a is the choice that asks for the diagonal
/// alone. Empty for islands whose information is singular, and where one of `others` is on another island.
std::vector<Eigen::Matrix3d> exact_relative_covariances(const RelationGraph& graph,
                                                        std::span<const Pose> poses, PatchId a,
                                                        std::span<const PatchId> others);

/// The same of an island of which much is asked: one factorisation, with its oldest patch held, for whatever
/// patches the covariances are relative to. Rounding leaves a share of 1e-8 or so of how well either end is
/// determined relative to the oldest patch: not for what lies near (local_relative_covariances).
class IslandCovariances {
 public:
  IslandCovariances(const RelationGraph& graph, std::span<const Pose> poses, IslandId island);

  /// Each of `others` relative to a; all on this island. Empty where its information is singular.
  std::vector<Eigen::Matrix3d> relative_to(PatchId a, std::span<const PatchId> others) const;

 private:
  std::vector<Pose> poses_;
  std::vector<int> row_;  ///< by patch id; -1: held, or elsewhere
  BlockCholesky<3> information_;
};

struct ConfidenceThreshold {
  double position_m = 0.5;
  double yaw_rad = 0.5;
};

/// Eq. 12 in a's own frame: 1.96 x (longer axis of the position ellipse) and 1.96 sigma_yaw within the
/// threshold.
bool well_determined(const Eigen::Matrix3d& relative_covariance, const ConfidenceThreshold& threshold);

}  // namespace isthmus
