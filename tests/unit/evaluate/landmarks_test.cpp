#include <gtest/gtest.h>

#include <cstdio>
#include <numbers>

#include "tests/support/temporary_directory.hpp"
#include "tools/evaluate/landmark_maps.hpp"
#include "tools/evaluate/report.hpp"

namespace isthmus {
namespace {

/// A round of 40 steps of 1 m past eight landmarks, each seen within 6 m; the same numbers with and without
/// noise.
std::string round_of(int rounds) {
  std::string text;
  Pose pose;
  const double turn = 2 * std::numbers::pi / 40;
  char line[200];
  for (int step = 0; step < 40 * rounds; ++step) {
    std::snprintf(line, sizeof line, "EDGE2 %d %d 1 0 %.12f 50 0 0 50 0 100\n", step, step + 1, turn);
    text += line;
    pose = pose * Pose{1, 0, turn};
    for (int k = 0; k < 8; ++k) {
      const Eigen::Vector2d tree = Pose{0, 6.4, 0} * rotate(k * std::numbers::pi / 4, {9, 0});
      const Eigen::Vector2d seen = inverse(pose) * tree;
      if (seen.norm() > 6) continue;
      std::snprintf(line, sizeof line, "LANDMARK %d %d %.12f %.12f 10 0 10\n", step + 1, 1000 + k, seen.x(),
                    seen.y());
      text += line;
    }
  }
  return text;
}

TEST(LandmarkLog, IsReadInOrderWithTheCovarianceOfTheSquareRoot) {
  const TemporaryDirectory directory;
  const LandmarkLog log = read_landmark_log(directory.write(
      "log.txt", "ODOMETRY 0 1 1 2 0.5 2 1 0 4 0 5\nLANDMARK 1 7 3 4 10 0 5\nEDGE2 1 2 1 0 0 1 0 0 1 0 1\n"));
  ASSERT_EQ(log.steps.size(), 3U);
  EXPECT_EQ(log.landmark_ids, std::vector<long>{7});
  EXPECT_EQ(log.steps[1].old_from_new, (Pose{1, 2, 0.5}));
  Eigen::Matrix3d root;
  root << 2, 1, 0, 0, 4, 0, 0, 0, 5;
  EXPECT_TRUE((root * log.steps[1].covariance * root.transpose()).isApprox(Eigen::Matrix3d::Identity()));
  ASSERT_EQ(log.steps[1].sightings.size(), 1U);
  EXPECT_TRUE(log.steps[1].sightings[0].covariance.isApprox(
      Eigen::Matrix2d(Eigen::Vector2d(0.01, 0.04).asDiagonal())));
}

TEST(LandmarkLog, ABadFileIsNamedWithItsLineAndTheReason) {
  const TemporaryDirectory directory;
  const std::string good = "EDGE2 0 1 1 0 0 1 0 0 1 0 1\n";
  const auto reason = [&](const std::string& text) {
    const std::string file = directory.write("bad.txt", text);
    return error_of([&] { read_landmark_log(file); }).substr(file.size());
  };
  EXPECT_EQ(reason(good + "EDGE2 1 2 1 0 0 1 0 0 1 0\n"), ":2: expected 12 fields, found 11");
  EXPECT_EQ(reason(good + "EDGE2 0 2 1 0 0 1 0 0 1 0 1\n"),
            ":2: from pose 0, but the pose reached last is 1");
  EXPECT_EQ(reason(good + "LANDMARK 1 5 1 x 1 0 1\n"), ":2: 'x' is not a finite number");
  EXPECT_EQ(reason(good + "LANDMARK 1 5 1 1 0 0 1\n"),
            ":2: a square root of information with a zero on its diagonal");
  EXPECT_EQ(reason(good + "TREE 1\n"), ":2: unknown line 'TREE'");
  EXPECT_EQ(reason("# nothing\n"), ":1: no ODOMETRY, EDGE2 or LANDMARK line");
}

TEST(LandmarkMaps, WithoutNoiseEveryEstimatorFindsTheTruth) {
  const TemporaryDirectory directory;
  const std::string file = directory.write("log.txt", round_of(2));
  for (const LandmarkAssociation association : {LandmarkAssociation::known, LandmarkAssociation::joint}) {
    const LandmarkEvaluation found = evaluate_landmarks({file, file, association, 0});
    EXPECT_EQ(found.landmarks, 8U);
    ASSERT_EQ(found.rows.size(), 3U);
    for (const LandmarkEvaluation::Row& row : found.rows) {
      EXPECT_LT(row.errors.pose_rmse_m, 1e-3) << row.name;
      EXPECT_LT(row.errors.landmark_rmse_m, 1e-3) << row.name;
      EXPECT_EQ(row.errors.landmarks, 8U) << row.name;
      EXPECT_EQ(row.map.wrong_pairs, 0U) << row.name;
    }
  }
}

TEST(LandmarkMaps, UnderFreshNoiseTheInvariantFormIsConsistent) {
  const TemporaryDirectory directory;
  const std::string file = directory.write("log.txt", round_of(3));
  const LandmarkEvaluation found = evaluate_landmarks({file, file, LandmarkAssociation::known, 20});
  ASSERT_EQ(found.fresh.size(), 2U);
  EXPECT_GT(found.fresh[0].nees_per_dof, 0.8);
  EXPECT_LT(found.fresh[0].nees_per_dof, 1.3);
  const std::string text = to_text({{}, {}, {}, found});
  EXPECT_NE(text.find("over 20 fresh noises"), std::string::npos);
  EXPECT_NE(to_json({{}, {}, {}, found}).find("\"nees_per_dof\""), std::string::npos);
}

TEST(LandmarkMaps, ATruthOfAnotherLogIsAnError) {
  const TemporaryDirectory directory;
  const std::string file = directory.write("log.txt", round_of(1)),
                    other = directory.write("other.txt", round_of(2));
  EXPECT_EQ(error_of([&] {
              evaluate_landmarks({file, other, LandmarkAssociation::known, 0});
            }),
            other + ": not of the poses and landmarks of the log");
}

}  // namespace
}  // namespace isthmus
