#pragma once

#include <string>

#include "server/engine/record/map_copy.hpp"
#include "server/output/tables/islands.hpp"

namespace isthmus {

/// An edge as g2o's EDGE_SE2 means it: with z the measured pose of b in a, the error is (x, y, yaw) of
/// z⁻¹ ∘ a_from_b, seen from z, and the cost ½ eᵀ I e.
struct G2oEdge {
  Pose measured_a_from_b;
  Eigen::Matrix3d information;
};

/// The relation's minimiser nearest to the fitted pose, and its Gauss-Newton information there, turned from
/// a's axes to those of the minimiser and weighted as the robust loss weights the relation in the fit.
G2oEdge g2o_edge(const Relation& relation, const Pose& fitted_a_from_b);

/// The way back: what an edge says, as a measurement of this project.
RelativePose relative_pose(const G2oEdge& edge);

/// Writes the pose graph: VERTEX_SE2 per patch, fixed tags among them (their yaw means nothing), EDGE_SE2 per
/// relation, one FIX per island (its first patch).
void write_g2o(const MapCopy& map, const RankedIslands& islands, const std::string& path);

}  // namespace isthmus
