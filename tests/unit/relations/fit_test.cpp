#include "relations/fit.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "relations/chordal.hpp"
#include "tests/unit/relations/small_maps.hpp"

namespace isthmus {
namespace {

using namespace small_maps;

double worst(const std::vector<Pose>& poses, const std::vector<Pose>& truth) {
  double found = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) found = std::max(found, distance(poses[i], truth[i]));
  return found;
}

TEST(Fit, OfExactMeasurementsReachesTheTruth) {
  std::mt19937 random(1);
  const SmallMap map = random_map(random, 30, 60, 0);
  std::vector<Pose> poses = disturbed(random, map.truth, 0.2);
  const FitReport report = fit_island(map.graph, PatchId{0}, poses);
  EXPECT_TRUE(report.ok) << report.message;
  EXPECT_GT(report.cost_before, 1);
  EXPECT_LT(report.cost_after, 1e-10);
  EXPECT_LT(worst(poses, map.truth), 1e-6);
}

TEST(Fit, WithChordalStartNeedsNoStart) {
  std::mt19937 random(2);
  SmallMap map = random_map(random, 40, 0, 0.02);
  for (int i = 0; i + 7 < 40; i += 3)
    map.graph.add(relation(
        i, i + 7, correspondences(points_on_walls(random, map.relative(i, i + 7), 20, {0.1, 1.7}, 0.02))));
  std::vector<Pose> near = map.truth;
  ASSERT_TRUE(fit_island(map.graph, PatchId{0}, near).ok);
  std::vector<Pose> far = map.truth;
  for (std::size_t i = 1; i < far.size(); ++i) far[i] = random_pose(random, 30);
  FitOptions options;
  options.chordal_start = true;
  EXPECT_TRUE(fit_island(map.graph, PatchId{0}, far, options).ok);
  EXPECT_LT(worst(far, near), 1e-4);
}

TEST(ChordalPoses, OfExactMeasurementsAreTheTruth) {
  std::mt19937 random(3);
  SmallMap map = random_map(random, 20, 0, 0);
  const FitProblem problem = make_fit_problem(map.graph, map.graph.patches_of(PatchId{0}));
  std::vector<Pose> nonsense(map.truth.size());
  nonsense[0] = map.truth[0];
  const auto found = chordal_poses(problem, poses_of(problem, nonsense));
  ASSERT_TRUE(found);
  EXPECT_LT(worst(*found, poses_of(problem, map.truth)), 1e-7);
}

// A relation whose yaw stands and falls with its place says little of the yaw alone: with the place unknown
// its information of 100 is worth 1, against 10 of the other's.
TEST(ChordalPoses, WeighAYawByWhatIsKnownOfItWithThePlaceUnknown) {
  SmallMap map(2);
  Eigen::Matrix3d coupled = Eigen::Vector3d(99, 1, 100).asDiagonal();
  coupled(0, 2) = coupled(2, 0) = 99;
  const double yaw = 0.4;
  map.graph.add(relation(0, 1, RelativePose{{1, 0, 0}, coupled}));
  map.graph.add(relation(0, 1, RelativePose{{1, 0, yaw}, Eigen::Vector3d(1, 1, 10).asDiagonal()}));
  const FitProblem problem = make_fit_problem(map.graph, map.graph.patches_of(PatchId{0}));
  const auto found = chordal_poses(problem, poses_of(problem, map.truth));
  ASSERT_TRUE(found);
  const double wanted = std::atan2(10 * std::sin(yaw), 1 + 10 * std::cos(yaw));
  for (std::size_t i = 0; i < 2; ++i)
    if (problem.patches[i] == PatchId{1}) {
      EXPECT_NEAR((*found)[i].yaw, wanted, 1e-9);
    }
}

TEST(ChordalPoses, ARelationThatSaysNothingOfTheYawAloneHasNoPartInIt) {
  SmallMap map(2);
  const Eigen::Vector3d line(3, 0, 3);  // only the sum of x and yaw is measured
  map.graph.add(relation(0, 1, RelativePose{{1, 0, -2}, line * line.transpose()}));
  map.graph.add(relation(0, 1, RelativePose{{1, 0, 0.4}, Eigen::Matrix3d::Identity()}));
  const FitProblem problem = make_fit_problem(map.graph, map.graph.patches_of(PatchId{0}));
  const auto found = chordal_poses(problem, poses_of(problem, map.truth));
  ASSERT_TRUE(found);
  for (std::size_t i = 0; i < 2; ++i)
    if (problem.patches[i] == PatchId{1}) {
      EXPECT_NEAR((*found)[i].yaw, 0.4, 1e-9);
    }
}

// Two relations of one pair that disagree by 2 m. Under the loss ρ(c) = s² log(1 + c / s²) the least cost is
// where the gradients cancel, w d = w' ρ'(w' d'²) d', and not at the mean of the two.
TEST(Fit, GivesARelationTheShareThatItsRobustLossLeavesIt) {
  constexpr double sure = 100, doubted = 100, scale = 3;
  SmallMap map(2);
  map.graph.add(relation(0, 1, RelativePose{{1, 0, 0}, sure * Eigen::Matrix3d::Identity()}));
  Relation outlier = relation(0, 1, RelativePose{{3, 0, 0}, doubted * Eigen::Matrix3d::Identity()});
  outlier.robust_scale = scale;
  map.graph.add(outlier);
  std::vector<Pose> poses{{}, {1.01, 0, 0}};
  ASSERT_TRUE(fit_island(map.graph, PatchId{0}, poses).ok);
  const double x = poses[1].x;
  const double weight = 1 / (1 + doubted * (3 - x) * (3 - x) / (scale * scale));
  EXPECT_NEAR(sure * (x - 1), doubted * weight * (3 - x), 0.01);
  EXPECT_GT(x, 1.02) << "it keeps a share";
  EXPECT_LT(x, 1.1) << "a small one";
}

// With one in twelve far off, the others say where the patch is.
TEST(Fit, ARobustLossKeepsAnOutlierFromBendingTheMap) {
  for (const double scale : {0.0, 2.0}) {
    SmallMap map(3);
    for (int i = 0; i < 2; ++i)
      map.graph.add(relation(i, i + 1, RelativePose{{1, 0, 0}, 400 * Eigen::Matrix3d::Identity()}));
    Relation outlier = relation(0, 2, RelativePose{{2, 3, 1}, 400 * Eigen::Matrix3d::Identity()});
    outlier.robust_scale = scale;
    map.graph.add(outlier);
    std::vector<Pose> poses{{}, {1, 0, 0}, {2, 0, 0}};
    ASSERT_TRUE(fit_island(map.graph, PatchId{0}, poses).ok);
    const double bent_m = std::hypot(poses[2].x - 2, poses[2].y);
    if (scale > 0) {
      EXPECT_LT(bent_m, 0.05);
    } else {
      EXPECT_GT(bent_m, 1);
    }
  }
}

TEST(Fit, HoldsTheLowestPatchOfAnIslandAsGauge) {
  std::mt19937 random(4);
  const SmallMap map = random_map(random, 10, 10, 0.1);
  std::vector<Pose> poses = disturbed(random, map.truth, 0.2);
  const Pose held = poses[0];
  ASSERT_TRUE(fit_island(map.graph, PatchId{0}, poses).ok);
  EXPECT_EQ(poses[0], held);
}

TEST(Fit, LeavesOtherIslandsAlone) {
  std::mt19937 random(5);
  SmallMap map(4);
  map.graph.add(relation(0, 1, RelativePose{{1, 0, 0}, Eigen::Matrix3d::Identity()}));
  map.graph.add(relation(2, 3, RelativePose{{2, 0, 0}, Eigen::Matrix3d::Identity()}));
  std::vector<Pose> poses(4);
  ASSERT_TRUE(fit_island(map.graph, PatchId{0}, poses).ok);
  EXPECT_NEAR(poses[1].x, 1, 1e-6);
  EXPECT_EQ(poses[2], Pose{});
  EXPECT_EQ(poses[3], Pose{});
}

//   [0] - 1 - 2 - [3] - 4      free: 1 and 2; 4 must not matter
TEST(Fit, OfAWindowHoldsItsBoundary) {
  SmallMap map(5);
  for (int i = 0; i < 4; ++i)
    map.graph.add(relation(i, i + 1, RelativePose{{1, 0, 0}, Eigen::Matrix3d::Identity()}));
  std::vector<Pose> poses(5);
  poses[3] = {3.3, 0, 0};
  poses[4] = {100, 0, 0};
  const std::vector<PatchId> window{PatchId{1}, PatchId{2}};
  ASSERT_TRUE(fit(map.graph, window, poses).ok);
  EXPECT_EQ(poses[0], Pose{});
  EXPECT_EQ(poses[3], (Pose{3.3, 0, 0}));
  EXPECT_EQ(poses[4], (Pose{100, 0, 0}));
  EXPECT_NEAR(poses[1].x, 1.1, 1e-6);
  EXPECT_NEAR(poses[2].x, 2.2, 1e-6);
}

TEST(Fit, HoldsOneGaugeForEachPartOfTheWindowWithoutBoundary) {
  SmallMap map(4);
  map.graph.add(relation(0, 1, RelativePose{{1, 0, 0}, Eigen::Matrix3d::Identity()}));
  map.graph.add(relation(2, 3, RelativePose{{2, 0, 0}, Eigen::Matrix3d::Identity()}));
  std::vector<Pose> poses{{5, 0, 0}, {}, {}, {9, 0, 0}};
  const std::vector<PatchId> window{PatchId{3}, PatchId{2}, PatchId{1}, PatchId{0}};
  ASSERT_TRUE(fit(map.graph, window, poses).ok);
  EXPECT_EQ(poses[3], (Pose{9, 0, 0}));
  EXPECT_NEAR(poses[2].x, 7, 1e-6);
  EXPECT_EQ(poses[1], Pose{});
  EXPECT_NEAR(poses[0].x, -1, 1e-6);
}

TEST(Fit, InACorridorLeavesThePlaceAlongItWhereItWas) {
  std::mt19937 random(6);
  SmallMap map(10);
  for (int i = 0; i < 10; ++i) map.truth[static_cast<std::size_t>(i)] = {2.0 * i, 0, 0};
  for (int i = 1; i < 10; ++i)
    map.graph.add(
        relation(i - 1, i, correspondences(points_on_walls(random, map.relative(i - 1, i), 30, {0}, 0.02))));
  std::vector<Pose> poses = map.truth;
  for (int i = 1; i < 10; ++i) poses[static_cast<std::size_t>(i)].y = 0.3;
  for (const bool chordal : {false, true}) {
    std::vector<Pose> fitted = poses;
    FitOptions options;
    options.chordal_start = chordal;
    const FitReport report = fit_island(map.graph, PatchId{0}, fitted, options);
    ASSERT_TRUE(report.ok) << report.message;
    for (std::size_t i = 0; i < 10; ++i) EXPECT_NEAR(fitted[i].x, 2.0 * static_cast<double>(i), 0.1);
    EXPECT_NEAR(fitted[9].y, 0, 0.1);
  }
}

TEST(Fit, WithARangeAloneMovesAlongIt) {
  SmallMap map(2);
  map.graph.add(relation(0, 1, Range{{0, 0}, {0, 0}, 3, 0.01}));
  std::vector<Pose> poses{{}, {4, 0, 0.5}};
  ASSERT_TRUE(fit_island(map.graph, PatchId{0}, poses).ok);
  EXPECT_LT(distance(poses[1], {3, 0, 0.5}), 1e-6);
}

TEST(Fit, RobustLossKeepsAFalseRelationFromBendingTheMap) {
  SmallMap map(12);
  for (int i = 0; i < 11; ++i)
    map.graph.add(relation(i, i + 1, RelativePose{{1, 0, 0}, 1e4 * Eigen::Matrix3d::Identity()}));
  Relation wrong = relation(0, 11, RelativePose{{5, 3, 1}, 1e4 * Eigen::Matrix3d::Identity()});
  wrong.robust_scale = 1;
  map.graph.add(wrong);
  std::vector<Pose> poses(12);
  for (int i = 0; i < 12; ++i) poses[static_cast<std::size_t>(i)] = {1.0 * i, 0, 0};
  const std::vector<Pose> truth = poses;
  ASSERT_TRUE(fit_island(map.graph, PatchId{0}, poses).ok);
  EXPECT_LT(worst(poses, truth), 0.02);
}

TEST(Fit, ThatFailsLeavesThePosesUntouched) {
  SmallMap map(3);
  map.graph.add(relation(0, 1, RelativePose{{1, 0, 0}, Eigen::Matrix3d::Identity()}));
  map.graph.add(relation(
      1, 2, RelativePose{{std::numeric_limits<double>::quiet_NaN(), 0, 0}, Eigen::Matrix3d::Identity()}));
  std::vector<Pose> poses{{}, {3, 1, 1}, {4, 2, 0}};
  const std::vector<Pose> before = poses;
  const FitReport report = fit_island(map.graph, PatchId{0}, poses);
  EXPECT_FALSE(report.ok);
  EXPECT_FALSE(report.message.empty());
  EXPECT_EQ(poses, before);
}

TEST(Fit, OfNothingIsDone) {
  SmallMap map(2);
  std::vector<Pose> poses{{1, 2, 3}, {3, 2, 1}};
  const std::vector<Pose> before = poses;
  const std::vector<PatchId> both{PatchId{0}, PatchId{1}};
  EXPECT_TRUE(fit(map.graph, both, poses).ok);
  EXPECT_EQ(poses, before);
}

TEST(Fit, TwiceGivesTheSameBits) {
  std::mt19937 random(7);
  const SmallMap map = random_map(random, 60, 200, 0.1);
  const std::vector<Pose> start = disturbed(random, map.truth, 0.2);
  for (const bool chordal : {false, true}) {
    FitOptions options;
    options.chordal_start = chordal;
    std::vector<Pose> first = start, second = start;
    const RelationGraph copy = map.graph;
    ASSERT_TRUE(fit_island(map.graph, PatchId{0}, first, options).ok);
    ASSERT_TRUE(fit_island(copy, PatchId{0}, second, options).ok);
    EXPECT_EQ(first, second);
    EXPECT_NE(first, start);
  }
}

TEST(Fit, NeverEndsAboveTheCostItBeganWith) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    const SmallMap map = random_map(random, 25, 80, 0.5);
    std::vector<Pose> poses = disturbed(random, map.truth, 1.0);
    FitOptions options;
    options.chordal_start = seed % 2 == 0;
    const FitReport report = fit_island(map.graph, PatchId{0}, poses, options);
    EXPECT_TRUE(report.ok) << report.message;
    EXPECT_LE(report.cost_after, report.cost_before);
  }
}

}  // namespace
}  // namespace isthmus
