#include "tools/evaluate/form_graph.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "relations/fit.hpp"

namespace isthmus {
namespace {

/// An edge with information (Ω_xx, Ω_yy, Ω_θθ) on its diagonal.
G2oFileEdge edge(std::int64_t from, std::int64_t to, const Pose& from_to,
                 const Eigen::Vector3d& information) {
  return {from, to, from_to, information.asDiagonal(), 0};
}

G2oFile without_poses(std::vector<G2oFileEdge> edges) {
  G2oFile file;
  for (const G2oFileEdge& one : edges) {
    file.vertices.try_emplace(one.from);
    file.vertices.try_emplace(one.to);
  }
  file.edges = std::move(edges);
  return file;
}

TEST(FormGraph, EdgesBecomeTheExactForm) {
  G2oFile file = without_poses({edge(7, 9, {1.1, 1.8, 0.4}, {20, 10, 50})});
  file.edges[0].information(0, 1) = file.edges[0].information(1, 0) = 3;
  file.vertices = {{7, Pose{0, 0, 0}}, {9, Pose{1, 2, 0.5}}};
  const FormGraph form = form_graph(file);
  ASSERT_EQ(form.graph.relations().size(), 1U);
  const Relation& relation = *form.graph.find(RelationId{0});
  EXPECT_EQ(relation.a, PatchId{0});
  EXPECT_EQ(form.poses[1], (Pose{1, 2, 0.5}));
  // tr(Ω_xy⁻¹) = 30 / (20 · 10 − 9); ‖R_j − R_i R̃‖² = 4 (1 − cos 0.1).
  const double tau = 2 / (30.0 / 191.0);
  const double f = 50 * 4 * (1 - std::cos(0.1)) + tau * (0.01 + 0.04);
  EXPECT_NEAR(2 * cost(relation, ominus(form.poses[1], form.poses[0])), f, 1e-10);
}

TEST(FormGraph, PosesWithoutVerticesAreComposedFromOdometryFirst) {
  const FormGraph form = form_graph(
      without_poses({edge(0, 2, {9, 9, 0}, {1, 1, 1}), edge(0, 1, {1, 0, std::numbers::pi / 2}, {1, 1, 1}),
                     edge(1, 2, {1, 0, 0}, {1, 1, 1}), edge(5, 2, {-1, 0, 0}, {1, 1, 1})}));
  ASSERT_EQ(form.poses.size(), 4U);
  EXPECT_NEAR(form.poses[2].x, 1, 1e-12);
  EXPECT_NEAR(form.poses[2].y, 1, 1e-12);
  EXPECT_NEAR(form.poses[3].y, 2, 1e-12);  // vertex 5, one metre further on
  EXPECT_EQ(form.graph.islands().size(), 1U);
}

TEST(FormGraph, ARingIsFittedFromOdometryAlone) {
  std::vector<G2oFileEdge> edges;
  for (int i = 0; i < 8; ++i) edges.push_back(edge(i, (i + 1) % 8, {1, 0, 0.7}, {100, 100, 1000}));
  FormGraph form = form_graph(without_poses(edges));
  FitOptions options;
  options.chordal_start = true;
  const FitReport report = fit_island(form.graph, PatchId{0}, form.poses, options);
  ASSERT_TRUE(report.ok);
  // 8 x 0.7 falls short of a turn by 0.683 rad: it is shared out, and the translations close almost freely.
  EXPECT_LT(report.cost_after, 0.2 * report.cost_before);
  EXPECT_NEAR(wrap_angle(form.poses[1].yaw - form.poses[0].yaw), std::numbers::pi / 4, 1e-6);
}

}  // namespace
}  // namespace isthmus
