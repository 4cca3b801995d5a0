#include "relations/g2o.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "relations/fit.hpp"

namespace isthmus {
namespace {

std::string error_of(const std::string& text) {
  std::istringstream stream(text);
  const auto result = read_g2o(stream, "graph.g2o");
  const auto* error = std::get_if<std::string>(&result);
  return error ? *error : "no error";
}

PoseGraphFile read(const std::string& text) {
  std::istringstream stream(text);
  return std::get<PoseGraphFile>(read_g2o(stream, "graph.g2o"));
}

TEST(G2o, EdgesBecomeTheExactForm) {
  const PoseGraphFile file =
      read("VERTEX_SE2 7 0 0 0\nVERTEX_SE2 9 1 2 0.5\nEDGE_SE2 7 9 1.1 1.8 0.4 20 3 0 10 0 50\n");
  ASSERT_EQ(file.graph.relations().size(), 1U);
  const Relation& relation = *file.graph.find(RelationId{0});
  EXPECT_EQ(relation.a, PatchId{0});
  EXPECT_EQ(file.poses[1], (Pose{1, 2, 0.5}));
  // tr(Ω_xy⁻¹) = 30 / (20 · 10 − 9); ‖R_j − R_i R̃‖² = 4 (1 − cos 0.1).
  const double tau = 2 / (30.0 / 191.0);
  const double f = 50 * 4 * (1 - std::cos(0.1)) + tau * (0.01 + 0.04);
  EXPECT_NEAR(2 * cost(relation, ominus(file.poses[1], file.poses[0])), f, 1e-10);
}

TEST(G2o, PosesWithoutVerticesAreComposedFromOdometryFirst) {
  const PoseGraphFile file = read(
      "EDGE_SE2 0 2 9 9 0 1 0 0 1 0 1\n"
      "EDGE_SE2 0 1 1 0 1.5707963267948966 1 0 0 1 0 1\n"
      "EDGE_SE2 1 2 1 0 0 1 0 0 1 0 1\n"
      "EDGE_SE2 5 2 -1 0 0 1 0 0 1 0 1\n");
  ASSERT_EQ(file.poses.size(), 4U);
  EXPECT_NEAR(file.poses[2].x, 1, 1e-12);
  EXPECT_NEAR(file.poses[2].y, 1, 1e-12);
  EXPECT_NEAR(file.poses[3].y, 2, 1e-12);  // vertex 5, one metre further on
  EXPECT_EQ(file.graph.islands().size(), 1U);
}

TEST(G2o, ErrorsNameFileLineAndReason) {
  const std::string good = "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n";
  EXPECT_EQ(error_of(good + "EDGE_SE3 0 1\n"), "graph.g2o:2: unknown tag 'EDGE_SE3'");
  EXPECT_EQ(error_of(good + "\nEDGE_SE2 0 1 1 0\n"), "graph.g2o:3: missing yaw");
  EXPECT_EQ(error_of("EDGE_SE2 0 1 1 0 zero 1 0 0 1 0 1\n"), "graph.g2o:1: yaw is not a number: 'zero'");
  EXPECT_EQ(error_of("EDGE_SE2 0 1 1 0 nan 1 0 0 1 0 1\n"), "graph.g2o:1: yaw is not a number: 'nan'");
  EXPECT_EQ(error_of("EDGE_SE2 0 1.5 1 0 0 1 0 0 1 0 1\n"),
            "graph.g2o:1: second vertex id is not a number: '1.5'");
  EXPECT_EQ(error_of("EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1 7\n"), "graph.g2o:1: unexpected field '7'");
  EXPECT_EQ(error_of("EDGE_SE2 3 3 1 0 0 1 0 0 1 0 1\n"), "graph.g2o:1: an edge joins a vertex to itself");
  EXPECT_EQ(error_of("EDGE_SE2 0 1 1 0 0 1 2 0 1 0 1\n"),
            "graph.g2o:1: information is not positive definite");
  EXPECT_EQ(error_of("VERTEX_SE2 0 0 0 0\n"), "graph.g2o: no EDGE_SE2 line");
  EXPECT_EQ(error_of(good), "no error");
}

TEST(G2o, ARingIsFittedFromOdometryAlone) {
  std::ostringstream text;
  text.precision(17);
  for (int i = 0; i < 8; ++i)
    text << "EDGE_SE2 " << i << ' ' << (i + 1) % 8 << " 1 0 0.7 100 0 0 100 0 1000\n";
  PoseGraphFile file = read(text.str());
  FitOptions options;
  options.chordal_start = true;
  const FitReport report = fit_island(file.graph, PatchId{0}, file.poses, options);
  ASSERT_TRUE(report.ok);
  // 8 x 0.7 falls short of a turn by 0.683 rad: it is shared out, and the translations close almost freely.
  EXPECT_LT(report.cost_after, 0.2 * report.cost_before);
  EXPECT_NEAR(wrap_angle(file.poses[1].yaw - file.poses[0].yaw), std::numbers::pi / 4, 1e-6);
}

}  // namespace
}  // namespace isthmus
