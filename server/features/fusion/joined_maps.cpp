#include "server/features/fusion/joined_maps.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "server/features/state/invariance.hpp"

namespace isthmus {
namespace {

/// Errors of the second map that are kept, and what they become in the first one's axes.
struct KeptErrors {
  int from = 0;      ///< in the second map's errors
  int to = 0;        ///< among those kept of it
  LocalMatrix turn;  ///< into the new axes
  ByMaps by_maps;    ///< how they move with the map
};

/// Appends the second map's robots and kept features to `joint`; its errors begin at `offset`.
std::vector<KeptErrors> append_kept(FeatureState& joint, const TiedMaps& maps, const std::vector<bool>& gone,
                                    int offset) {
  const FeatureState& two = maps.two;
  const double yaw = maps.one_from_two.yaw;
  const int robots = static_cast<int>(joint.robots.size());
  std::vector<KeptErrors> kept;
  int next = 0;
  const auto there = [&](const RobotInState& one) {
    const RobotInState moved{maps.one_from_two * one.map_from_robot, offset + next};
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity(), rigid = Eigen::Matrix3d::Identity();
    turn.topLeftCorner<2, 2>() = turn_of(FeatureKind::point, yaw);
    rigid.topRightCorner<2, 1>() = quarter_turn(position(moved.map_from_robot) - maps.about);
    kept.push_back({one.offset, next, turn, rigid});
    next += 3;
    return moved;
  };
  for (const RobotInState& robot : two.robots) joint.robots.push_back(there(robot));
  for (const MarkInState& mark : two.marks)
    joint.marks.push_back({mark.id + joint.next_id, there(mark.stood)});
  for (std::size_t i = 0; i < two.features.size(); ++i) {
    if (gone[i]) continue;
    FeatureInState entry = two.features[i];
    const Feature moved = maps.one_from_two * entry.feature;
    const LocalMatrix b = project_to_local(moved);
    kept.push_back({entry.offset, next, b * turn_of(moved.kind, yaw) * project_to_feature(entry.feature),
                    b * rigid_motion(moved, maps.about)});
    entry.id += joint.next_id;
    entry.robot += robots;
    entry.feature = moved;
    entry.offset = offset + next;
    joint.features.push_back(entry);
    next += dimension(moved);
  }
  joint.next_id += two.next_id;
  return kept;
}

/// The second map's own covariance of what is kept, in the new axes.
void turn_covariance(const Eigen::MatrixXd& p, const std::vector<KeptErrors>& kept,
                     Eigen::Ref<Eigen::MatrixXd> turned) {
  for (const KeptErrors& row : kept) {
    for (const KeptErrors& column : kept) {
      if (column.to > row.to) continue;
      const LocalMatrix half =
          row.turn.lazyProduct(p.block(row.from, column.from, row.turn.cols(), column.turn.cols()));
      turned.block(row.to, column.to, half.rows(), column.turn.rows()) =
          half.lazyProduct(column.turn.transpose());
    }
  }
}

}  // namespace

FeatureState joined_maps(const TiedMaps& maps, const TieFilter& ties, const std::vector<bool>& gone) {
  FeatureState joint{maps.one.form, maps.one.robots, maps.one.features, {}, maps.one.next_id, {},
                     maps.one.marks};
  const Eigen::Index first = maps.one.covariance.rows(), rows = ties.rows();
  const std::vector<KeptErrors> kept = append_kept(joint, maps, gone, static_cast<int>(first));
  const Eigen::Index more = kept.empty() ? 0 : kept.back().to + kept.back().turn.rows();
  Eigen::MatrixXd gain(first + more, rows);  // Wᵀ of what is kept, and N, by where the second map lies
  Eigen::MatrixXd by_place = Eigen::MatrixXd::Zero(first + more, 3);
  gain.topRows(first) = ties.gain_one();
  for (const KeptErrors& one : kept) {
    const Eigen::Index size = one.turn.rows();
    gain.middleRows(first + one.to, size) =
        one.turn.lazyProduct(ties.gain_two().middleRows(one.from, one.turn.cols()));
    by_place.middleRows(first + one.to, size) = one.by_maps;
  }
  // P − WᵀW + (N − WᵀV)(VᵀV)⁻¹(N − WᵀV)ᵀ, the lower triangle.
  const Eigen::Matrix3d root = ties.maps_covariance().llt().matrixL();
  const Eigen::MatrixXd place = (by_place - gain * ties.by_maps()) * root;
  Eigen::MatrixXd& p = joint.covariance;
  p = Eigen::MatrixXd::Zero(first + more, first + more);
  p.topLeftCorner(first, first) = maps.one.covariance;
  turn_covariance(maps.two.covariance, kept, p.bottomRightCorner(more, more));
  p.selfadjointView<Eigen::Lower>().rankUpdate(gain, -1);
  p.selfadjointView<Eigen::Lower>().rankUpdate(place, 1);
  p.triangularView<Eigen::StrictlyUpper>() = p.transpose();
  const Eigen::Vector3d moved = ties.maps_correction();
  const Eigen::VectorXd rest = ties.residual() - ties.by_maps() * moved;
  const Eigen::VectorXd delta = gain * rest + by_place * moved;
  apply_correction(joint, delta);
  return joint;
}

}  // namespace isthmus
