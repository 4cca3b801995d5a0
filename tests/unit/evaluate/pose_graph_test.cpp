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
  EXPECT_EQ(fit.failure, "");
  EXPECT_EQ(fit.patches, 4U);
  EXPECT_EQ(fit.relations, 4U);
  EXPECT_EQ(fit.islands, 1U);
  EXPECT_NEAR(fit.f_before, 0.16, 1e-9);
  EXPECT_NEAR(fit.f_after, 0.04, 1e-9);
}

TEST(PoseGraphFit, WhereThereIsNoSolutionTheReasonIsSaid) {
  const TemporaryDirectory directory;
  const std::string file = directory.write("huge.g2o",
                                           "EDGE_SE2 0 1 1e200 0 0 1 0 0 1 0 1\n"
                                           "EDGE_SE2 0 1 -1e200 0 0 1 0 0 1 0 1\n");
  EXPECT_EQ(fit_pose_graph(file).failure,
            file + ": no solution for the island of patch 0: the cost is not finite at the given poses");
}

TEST(PoseGraphFit, ABadFileIsNamedWithItsLine) {
  const TemporaryDirectory directory;
  const std::string file = directory.write("bad.g2o", "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nEDGE_SE2 0 1 1\n");
  EXPECT_EQ(error_of([&] { fit_pose_graph(file); }).find(file + ":2: "), 0U);
}

TEST(EvaluationReport, HoldsEveryFigureInTextAndJson) {
  Evaluation evaluation;
  evaluation.relations["intra"] = {10, 2, {0.0125, 0.008, 0.011, 0.09}, {0.25, 0.2, 0.19, 1}, {}, {}};
  AbsoluteErrors& absolute = evaluation.absolute.emplace();
  IslandErrors& island = absolute.islands.emplace_back();
  island.island = 3;
  island.robots["R1"] = {5, {0.1, 0.02, 0.09, 0.2, 0.125}, {1.5, 0.25, 1.25, 2.5, 1.75}};
  island.robots["R2"] = island.robots["R1"];
  island.team = island.robots["R1"];
  island.tags = 4;
  island.tag_translation_m = {0.3, 0.04, 0.29, 0.4, 0.3125};
  absolute.missing = {{"R1", 6}};
  absolute.missing_tags = 2;
  const std::string text = to_text(evaluation);
  EXPECT_NE(text.find("intra: 10 relations, 2 missing"), std::string::npos);
  EXPECT_NE(text.find("0.0125"), std::string::npos);
  for (const char* figure :
       {"island 3, aligned", "  R1 ", "  all robots ", "position mean   0.1000 ±   0.0200",
        "rmse   0.1250  max   0.2000 m (5)", "heading  mean   1.5000 ±   0.2500",
        "rmse   1.7500  max   2.5000 deg (5)", "rmse   0.3125  max   0.4000 m (4)",
        "R1: 6 stamps of the truth without a pose", "2 true tags without a place"}) {
    EXPECT_NE(text.find(figure), std::string::npos) << figure << "\n" << text;
  }
  const std::string json = to_json(evaluation);
  EXPECT_NE(json.find("\"missing\": 2"), std::string::npos);
  EXPECT_NE(json.find("\"median\": 0.011"), std::string::npos);
  EXPECT_NE(json.find("\"rms_m\": 0.125"), std::string::npos);
  EXPECT_NE(json.find("\"missing_tags\": 2"), std::string::npos);
}

TEST(EvaluationReport, GivesNoFiguresWhereNothingCouldBeCompared) {
  Evaluation evaluation;
  evaluation.relations["inter"].missing = 7;
  EXPECT_EQ(to_text(evaluation), "inter: 0 relations, 7 missing\n");
  EXPECT_EQ(to_json(evaluation).find("mean"), std::string::npos);
}

}  // namespace
}  // namespace isthmus
