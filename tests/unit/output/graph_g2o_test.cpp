#include "server/output/tables/graph_g2o.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "tests/unit/output/room.hpp"
#include "tools/text/g2o.hpp"

namespace isthmus {
namespace {

using testing::lines;
using testing::TemporaryDirectory;

/// g2o's EdgeSE2: error = (z⁻¹ ∘ a_from_b) as (x, y, yaw), cost = ½ errorᵀ I error.
double g2o_cost(const G2oEdge& edge, const Pose& a_from_b) {
  const Eigen::Vector3d error = to_vector(inverse(edge.measured_a_from_b) * a_from_b);
  return 0.5 * error.dot(edge.information * error);
}

Eigen::Matrix3d correlated_information() {
  Eigen::Matrix3d information;
  information << 400, 150, -60,  //
      150, 900, 80,              //
      -60, 80, 2500;
  return information;
}

// Around a pose turned by 1.9 rad, so that information in a's axes would be far off.
TEST(GraphG2o, TheCostOfAMeasuredPoseIsTheRelationsOwn) {
  const Pose measured{2, -1, 1.9};
  const Relation relation =
      testing::relative_pose(PatchId{0}, PatchId{1}, measured, correlated_information());
  const G2oEdge edge = g2o_edge(relation, {2.05, -1.02, 1.92});
  EXPECT_NEAR(edge.measured_a_from_b.x, 2, 1e-9);
  EXPECT_NEAR(edge.measured_a_from_b.yaw, 1.9, 1e-9);
  for (const Pose& step : {Pose{0.3, 0, 0}, Pose{0, 0.2, 0}, Pose{0, 0, 0.1}, Pose{0.2, -0.3, 0.05}}) {
    const Pose at{measured.x + step.x, measured.y + step.y, measured.yaw + step.yaw};
    const double wanted = cost(relation.measurement, at);
    EXPECT_NEAR(g2o_cost(edge, at), wanted, 1e-9 * wanted);
  }
}

TEST(GraphG2o, TheCostOfCorrespondencesIsTheirsNearTheirMinimum) {
  const Pose truth{3, 1, 2.2};
  QuadraticFormBuilder builder;
  // Walls in three directions; points off the origin correlate x, y and yaw.
  for (const double normal_yaw : {0.2, 1.4, 2.9}) {
    const Eigen::Vector2d normal = rotate(normal_yaw, Eigen::Vector2d::UnitX());
    for (int i = 0; i < 5; ++i) {
      const Eigen::Vector2d on_a = 4 * normal + 0.6 * i * rotate(normal_yaw, Eigen::Vector2d::UnitY());
      const Eigen::Vector2d noise = (i % 2 == 0 ? 0.002 : -0.002) * normal;
      builder.point_on_line(inverse(truth) * (on_a + noise).eval(), on_a, normal, 0.03);
    }
  }
  Relation relation;
  relation.measurement = Correspondences{builder.build(), 15, {}};
  const G2oEdge edge = g2o_edge(relation, truth);
  const Pose& z = edge.measured_a_from_b;
  const double least = cost(relation.measurement, z);
  EXPECT_GT(std::abs(edge.information(0, 1)) + std::abs(edge.information(0, 2)), 1) << "correlated";
  for (const Pose& step : {Pose{1e-3, 0, 0}, Pose{0, 1e-3, 0}, Pose{0, 0, 1e-3}, Pose{1e-3, -2e-3, 5e-4}}) {
    const Pose at{z.x + step.x, z.y + step.y, z.yaw + step.yaw};
    const double wanted = cost(relation.measurement, at) - least;
    EXPECT_GT(wanted, 0);
    EXPECT_NEAR(g2o_cost(edge, at), wanted, 0.01 * wanted);
  }
}

TEST(GraphG2o, ARobustRelationHasTheWeightItHasInTheFit) {
  const Pose measured{1, 0, 0};
  Relation relation = testing::relative_pose(PatchId{0}, PatchId{1}, measured, correlated_information());
  const Eigen::Matrix3d full = g2o_edge(relation, measured).information;
  relation.robust_scale = 1;
  EXPECT_NEAR(g2o_edge(relation, measured).information(0, 0), full(0, 0), 1e-9 * full(0, 0));
  // Half a metre off: c = 100, so Cauchy leaves 1 / (1 + c) of the weight.
  const Pose off{1.5, 0, 0};
  const double c = 2 * cost(relation.measurement, off);
  EXPECT_NEAR(g2o_edge(relation, off).information(0, 0), full(0, 0) / (1 + c), 1e-6 * full(0, 0));
}

TEST(GraphG2o, TheFileHasVerticesAFixPerIslandAndEdges) {
  MapCopy map = testing::map_of({}, {{0, 0, 0}, {1, 0, 0.5}, {7, 7, 0}});
  map.graph.remove(map.graph.between(PatchId{1}, PatchId{2}).front());
  const TemporaryDirectory directory;
  write_g2o(map, rank_islands(map), directory.file("graph.g2o"));
  const auto rows = lines(directory.file("graph.g2o"));
  ASSERT_EQ(rows.size(), 6u);
  EXPECT_EQ(rows[0], "VERTEX_SE2 0 0 0 0");
  EXPECT_EQ(rows[1], "VERTEX_SE2 1 1 0 0.5");
  EXPECT_EQ(rows[2], "VERTEX_SE2 2 7 7 0");
  EXPECT_EQ(rows[3], "FIX 0");
  EXPECT_EQ(rows[4], "FIX 2");
  // x and y are as good, so their information does not turn.
  std::istringstream edge(rows[5]);
  std::string tag;
  edge >> tag;
  EXPECT_EQ(tag, "EDGE_SE2");
  for (const double wanted : {0.0, 1.0, 1.0, 0.0, 0.5, 400.0, 0.0, 0.0, 400.0, 0.0, 1600.0}) {
    double value = -1;
    edge >> value;
    EXPECT_NEAR(value, wanted, 1e-9) << rows[5];
  }
  EXPECT_TRUE((edge >> std::ws).eof()) << rows[5];
}

Relation between(Measurement measurement) {
  Relation relation;
  relation.a = PatchId{0};
  relation.b = PatchId{1};
  relation.measurement = std::move(measurement);
  return relation;
}

/// A graph of two patches and this relation, as written and read again.
G2oFile read_again(const Relation& relation) {
  MapCopy map = testing::map_of({}, {{0, 0, 0}, {2, 1, 0.5}});
  map.graph.remove(map.graph.between(PatchId{0}, PatchId{1}));
  map.graph.add(relation);
  const TemporaryDirectory directory;
  write_g2o(map, rank_islands(map), directory.file("graph.g2o"));
  return read_g2o(directory.file("graph.g2o"));
}

// Solvers refuse what is not positive definite, and a part of a pose alone is not.
TEST(GraphG2o, RelationsThatTellLessThanAPoseAreReadAgain) {
  QuadraticFormBuilder point;  // a sighting: where b's origin is, to 1 mm
  point.point_on_line({0, 0}, {2, 1}, {1, 0}, 0.001);
  point.point_on_line({0, 0}, {2, 1}, {0, 1}, 0.001);
  for (const auto& [what, relation] :
       {std::pair{"range", between(Range{{0, 0}, {0, 0}, 2.2, 0.1})},
        {"sharp range of lever arms", between(Range{{3, 4}, {-2, 7}, 9, 1e-4})},
        {"bearing", between(Bearing{{0.1, 0, 0.2}, {0.3, 0}, 0.4, 0.02})},
        {"point", between(Correspondences{point.build(), 1, {}})}}) {
    EXPECT_NO_THROW(EXPECT_EQ(read_again(relation).edges.size(), 1U)) << what;
  }
}

}  // namespace
}  // namespace isthmus
