#include "tools/evaluate/pose_graph.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_directory.hpp"
#include "tools/evaluate/report.hpp"

namespace isthmus {
namespace {

TEST(PoseGraphFit, ALoopThatDoesNotCloseIsSpreadOverItsEdges) {
  const TemporaryDirectory directory;
  // Three steps of 1 m along a line and one edge that says 3.4 m: the optimum gives each a quarter of 0.4 m.
  const PoseGraphFit fit = fit_pose_graph(directory.write("line.g2o",
                                                          "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n"
                                                          "EDGE_SE2 1 2 1 0 0 1 0 0 1 0 1\n"
                                                          "EDGE_SE2 2 3 1 0 0 1 0 0 1 0 1\n"
                                                          "EDGE_SE2 0 3 3.4 0 0 1 0 0 1 0 1\n"));
  EXPECT_TRUE(fit.ok);
  EXPECT_EQ(fit.patches, 4U);
  EXPECT_EQ(fit.relations, 4U);
  EXPECT_EQ(fit.islands, 1U);
  EXPECT_NEAR(fit.f_before, 0.16, 1e-9);
  EXPECT_NEAR(fit.f_after, 0.04, 1e-9);
}

TEST(PoseGraphFit, ABadFileIsNamedWithItsLine) {
  const TemporaryDirectory directory;
  const std::string file = directory.write("bad.g2o", "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nEDGE_SE2 0 1 1\n");
  EXPECT_EQ(error_of([&] { fit_pose_graph(file); }).find(file + ":2: "), 0U);
}

TEST(EvaluationReport, HoldsEveryFigureInTextAndJson) {
  Evaluation evaluation;
  evaluation.relations["intra"] = {10, 2, {0.0125, 0.008, 0.011, 0.09}, {0.25, 0.2, 0.19, 1}, {}, {}};
  evaluation.absolute.push_back({"R1", 0, 5, 0.125, {}, {}});
  const std::string text = to_text(evaluation);
  EXPECT_NE(text.find("intra: 10 relations, 2 missing"), std::string::npos);
  EXPECT_NE(text.find("0.0125"), std::string::npos);
  EXPECT_NE(text.find("R1 on island 0, aligned: 5 poses, rms 0.1250 m"), std::string::npos);
  const std::string json = to_json(evaluation);
  EXPECT_NE(json.find("\"missing\": 2"), std::string::npos);
  EXPECT_NE(json.find("\"median\": 0.011"), std::string::npos);
}

TEST(EvaluationReport, GivesNoFiguresWhereNothingCouldBeCompared) {
  Evaluation evaluation;
  evaluation.relations["inter"].missing = 7;
  EXPECT_EQ(to_text(evaluation), "inter: 0 relations, 7 missing\n");
  EXPECT_EQ(to_json(evaluation).find("mean"), std::string::npos);
}

}  // namespace
}  // namespace isthmus
