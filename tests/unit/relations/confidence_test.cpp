#include "relations/confidence.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/unit/relations/small_maps.hpp"

namespace isthmus {
namespace {

using namespace small_maps;

const Eigen::Matrix3d some_information = Eigen::Vector3d(100, 25, 400).asDiagonal();

TEST(RelativeCovariance, OfNeighboursIsTheInverseOfTheirRelationsInformation) {
  SmallMap map(2);
  map.graph.add(relation(0, 1, RelativePose{{1, 0, 0.2}, some_information}));
  const std::vector<Pose> poses{{5, 5, 1.3}, Pose{5, 5, 1.3} * Pose{1, 0, 0.2}};
  const auto local = local_relative_covariances(map.graph, poses, PatchId{0});
  ASSERT_EQ(local.size(), 1U);
  EXPECT_TRUE(local.at(PatchId{1}).isApprox(some_information.inverse(), 1e-9));
  const std::vector<PatchId> others{PatchId{1}, PatchId{0}};
  const auto exact = exact_relative_covariances(map.graph, poses, PatchId{0}, others);
  ASSERT_EQ(exact.size(), 2U);
  EXPECT_TRUE(exact[0].isApprox(some_information.inverse(), 1e-9));
  EXPECT_EQ(exact[1], Eigen::Matrix3d::Zero());
}

TEST(RelativeCovariance, DoesNotTurnWithTheMap) {
  std::mt19937 random(1);
  const SmallMap map = random_map(random, 15, 30, 0.05);
  std::vector<Pose> moved = map.truth;
  for (Pose& pose : moved) pose = Pose{40, -7, 2} * pose;
  const auto here = local_relative_covariances(map.graph, map.truth, PatchId{3});
  const auto there = local_relative_covariances(map.graph, moved, PatchId{3});
  ASSERT_EQ(here.size(), 14U);
  for (const auto& [patch, covariance] : here) EXPECT_TRUE(there.at(patch).isApprox(covariance, 1e-7));
}

TEST(RelativeCovariance, OfTheWholeIslandAgreesLocallyAndExactly) {
  std::mt19937 random(2);
  const SmallMap map = random_map(random, 60, 150, 0.05);
  const std::vector<PatchId> others = map.graph.patches_of(PatchId{0});
  const auto exact = exact_relative_covariances(map.graph, map.truth, PatchId{11}, others);
  const auto local = local_relative_covariances(map.graph, map.truth, PatchId{11}, 60);
  ASSERT_EQ(exact.size(), 60U);
  ASSERT_EQ(local.size(), 59U);
  for (const auto& [patch, covariance] : local)
    EXPECT_TRUE(covariance.isApprox(exact[static_cast<std::size_t>(patch.value)], 1e-9));
}

// Whatever patch is held.
TEST(IslandCovariances, AreTheExactOnesOfAnyTwoPatches) {
  std::mt19937 random(2);
  SmallMap map = random_map(random, 60, 150, 0.05);
  for (Pose& pose : map.truth) pose = Pose{40, -7, 2} * pose;
  const std::vector<PatchId> others = map.graph.patches_of(PatchId{0});
  const IslandCovariances island(map.graph, map.truth, PatchId{0});
  for (const PatchId a : {PatchId{0}, PatchId{11}, PatchId{59}}) {
    const auto exact = exact_relative_covariances(map.graph, map.truth, a, others);
    const auto found = island.relative_to(a, others);
    ASSERT_EQ(found.size(), exact.size());
    for (std::size_t i = 0; i < exact.size(); ++i)
      EXPECT_TRUE((found[i] - exact[i]).isZero(1e-9)) << a.value << " " << i;
  }
}

// A chain of 500 m whose oldest patch is far from both ends that are asked of.
TEST(IslandCovariances, AreAsGoodToAMillimetreFarFromThePatchThatIsHeld) {
  constexpr int count = 1000;
  SmallMap map(count);
  for (int i = 0; i < count; ++i) map.truth[static_cast<std::size_t>(i)] = {0.5 * i, 0, 0};
  const Eigen::Matrix3d information = Eigen::Vector3d(1e5, 1e5, 1e6).asDiagonal();
  for (int i = 1; i < count; ++i) map.graph.add(relation(i - 1, i, RelativePose{{0.5, 0, 0}, information}));
  const std::vector<PatchId> others{PatchId{count - 2}, PatchId{count - 50}};
  const PatchId last{count - 1};
  const auto exact = exact_relative_covariances(map.graph, map.truth, last, others);
  const auto found = IslandCovariances(map.graph, map.truth, PatchId{0}).relative_to(last, others);
  ASSERT_EQ(found.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_TRUE((found[i] - exact[i]).isZero(1e-6)) << i;
}

TEST(IslandCovariances, HaveNothingWhereTheIslandIsNotDeterminedAndZeroOfOnePatchAlone) {
  SmallMap map(3);
  map.graph.add(relation(0, 1, Range{{0, 0}, {0, 0}, 3, 0.01}));
  const std::vector<PatchId> both{PatchId{0}, PatchId{1}}, alone{PatchId{2}};
  EXPECT_TRUE(IslandCovariances(map.graph, map.truth, PatchId{0}).relative_to(PatchId{0}, both).empty());
  const auto of_itself = IslandCovariances(map.graph, map.truth, PatchId{2}).relative_to(PatchId{2}, alone);
  ASSERT_EQ(of_itself.size(), 1U);
  EXPECT_EQ(of_itself.front(), Eigen::Matrix3d::Zero());
}

TEST(RelativeCovariance, HasNothingForPatchesWithoutRelation) {
  SmallMap map(3);
  EXPECT_TRUE(local_relative_covariances(map.graph, map.truth, PatchId{0}).empty());
  map.graph.add(relation(0, 1, RelativePose{{1, 0, 0}, some_information}));
  const auto local = local_relative_covariances(map.graph, map.truth, PatchId{0});
  EXPECT_EQ(local.size(), 1U);
  EXPECT_FALSE(local.contains(PatchId{2}));
  const std::vector<PatchId> elsewhere{PatchId{2}};
  EXPECT_TRUE(exact_relative_covariances(map.graph, map.truth, PatchId{0}, elsewhere).empty());
}

//   0 === 1 === 2 --- 3     === a corridor: nothing along x; --- a full relation
TEST(RelativeCovariance, NeverClaimsThePlaceAlongACorridor) {
  std::mt19937 random(3);
  SmallMap map(4);
  for (int i = 0; i < 4; ++i) map.truth[static_cast<std::size_t>(i)] = {2.0 * i, 0, 0};
  for (int i = 1; i < 3; ++i)
    map.graph.add(
        relation(i - 1, i, correspondences(points_on_walls(random, map.relative(i - 1, i), 50, {0}, 0.02))));
  map.graph.add(relation(2, 3, RelativePose{{2, 0, 0}, some_information}));
  const ConfidenceThreshold loose{50, 3};
  for (const auto& [patch, covariance] : local_relative_covariances(map.graph, map.truth, PatchId{0}))
    EXPECT_FALSE(well_determined(covariance, loose)) << patch.value;
  // From the other side of the corridor the full relation still counts.
  const auto from_2 = local_relative_covariances(map.graph, map.truth, PatchId{2});
  ASSERT_TRUE(from_2.contains(PatchId{3}));
  EXPECT_TRUE(from_2.at(PatchId{3}).isApprox(Eigen::Matrix3d(some_information.inverse()), 0.1));
  const std::vector<PatchId> others{PatchId{3}};
  EXPECT_TRUE(exact_relative_covariances(map.graph, map.truth, PatchId{2}, others).empty());
}

TEST(RelativeCovariance, OdometryAlongACorridorDeterminesIt) {
  std::mt19937 random(4);
  SmallMap map(20);
  for (int i = 0; i < 20; ++i) map.truth[static_cast<std::size_t>(i)] = {2.0 * i, 0, 0};
  for (int i = 1; i < 20; ++i) {
    map.graph.add(
        relation(i - 1, i, correspondences(points_on_walls(random, map.relative(i - 1, i), 50, {0}, 0.02))));
    map.graph.add(relation(i - 1, i, RelativePose{{2, 0, 0}, some_information}));
  }
  const auto local = local_relative_covariances(map.graph, map.truth, PatchId{0});
  ASSERT_EQ(local.size(), 19U);
  EXPECT_NEAR(local.at(PatchId{19})(0, 0), 19 / 100.0, 0.01);
  EXPECT_LT(local.at(PatchId{19})(1, 1), 0.1);
}

TEST(RelativeCovariance, LeavesOutPatchesThatHangByARangeAlone) {
  SmallMap map(4);
  map.truth = {{0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {4, 0, 0}};
  map.graph.add(relation(0, 1, Range{{0, 0}, {0, 0}, 3, 0.01}));
  map.graph.add(relation(0, 2, RelativePose{{0, 2, 0}, some_information}));
  map.graph.add(relation(1, 3, RelativePose{{1, 0, 0}, some_information}));
  const auto local = local_relative_covariances(map.graph, map.truth, PatchId{0});
  EXPECT_TRUE(local.contains(PatchId{2}));
  EXPECT_FALSE(local.contains(PatchId{1}));
  EXPECT_FALSE(local.contains(PatchId{3}));
}

TEST(RelativeCovariance, ThreeRangesToKnownPatchesDetermineTheirPlaceButNotTheYaw) {
  SmallMap map(4);
  map.truth = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0.5}};
  for (int i = 1; i < 3; ++i)
    map.graph.add(relation(0, i, RelativePose{map.relative(0, i), some_information}));
  for (int i = 0; i < 3; ++i) {
    const Pose pose = map.relative(i, 3);
    map.graph.add(relation(i, 3, Range{{0, 0}, {0, 0}, std::hypot(pose.x, pose.y), 0.1}));
  }
  EXPECT_FALSE(local_relative_covariances(map.graph, map.truth, PatchId{0}).contains(PatchId{3}));
}

//   0 --- 1 --- 2     --- full relations; 3 hangs by ranges to 1 and 2
TEST(RelativeCovariance, OfDeterminedPatchesKeepsItsDigitsBesideAnUndeterminedOne) {
  std::mt19937 random(5);
  SmallMap map = random_map(random, 3, 0, 0);
  const auto without = local_relative_covariances(map.graph, map.truth, PatchId{0});
  map.graph.add_patch(PatchId{3});
  map.truth.push_back(map.pose(2) * Pose{2, 1, 0.4});
  for (int i = 1; i < 3; ++i) map.graph.add(relation(i, 3, Range{{0.3, 0.1}, {0.2, -0.4}, 2, 0.05}));
  const auto with = local_relative_covariances(map.graph, map.truth, PatchId{0});
  EXPECT_FALSE(with.contains(PatchId{3}));
  for (const auto& [patch, covariance] : without) EXPECT_TRUE(with.at(patch).isApprox(covariance, 1e-10));
}

// What is left out must count as if it had never been related.
TEST(RelativeCovariance, LeavesOutRelationsThatDoNotCount) {
  std::mt19937 random(3);
  SmallMap map = random_map(random, 12, 20, 0.05);
  const auto without = local_relative_covariances(map.graph, map.truth, PatchId{2}, 12);
  for (int i = 0; i < 6; ++i) {
    Relation seen = relation(i, i + 6, RelativePose{map.relative(i, i + 6), 1e4 * some_information});
    seen.origin.kind = OriginKind::sighting;
    map.graph.add(seen);
  }
  const auto no_sighting = [](const Relation& r) { return r.origin.kind != OriginKind::sighting; };
  const auto all = local_relative_covariances(map.graph, map.truth, PatchId{2}, 12);
  const auto filtered = local_relative_covariances(map.graph, map.truth, PatchId{2}, 12, no_sighting);
  ASSERT_EQ(filtered.size(), 11U);
  for (const auto& [patch, covariance] : without) {
    EXPECT_TRUE(filtered.at(patch).isApprox(covariance, 1e-9)) << patch.value;
    EXPECT_LT(all.at(patch).trace(), covariance.trace()) << patch.value;
  }
  const auto none = [](const Relation&) { return false; };
  EXPECT_TRUE(local_relative_covariances(map.graph, map.truth, PatchId{2}, 12, none).empty());
}

TEST(RelativeCovariance, OfOnePatchAgreesWithTheExactOneWhereAllIsLookedAt) {
  std::mt19937 random(4);
  const SmallMap map = random_map(random, 20, 25, 0.05);
  const std::vector<PatchId> far{PatchId{17}};
  const auto exact = exact_relative_covariances(map.graph, map.truth, PatchId{3}, far);
  ASSERT_EQ(exact.size(), 1U);
  const auto whole = local_relative_covariance(map.graph, map.truth, PatchId{3}, PatchId{17}, 40);
  ASSERT_TRUE(whole);
  EXPECT_TRUE(whole->isApprox(exact[0], 1e-9));
  EXPECT_EQ(local_relative_covariance(map.graph, map.truth, PatchId{3}, PatchId{3}, 40),
            Eigen::Matrix3d::Zero());
}

// A chain of 60: five patches about either end say nothing of what lies between; and where they do, they say
// no more than the whole.
TEST(RelativeCovariance, OfOnePatchIsNothingOrABoundWhereOnlyTheEndsAreLookedAt) {
  std::mt19937 random(5);
  const SmallMap map = random_map(random, 60, 0, 0.05);
  EXPECT_FALSE(local_relative_covariance(map.graph, map.truth, PatchId{5}, PatchId{55}, 10));
  const std::vector<PatchId> near{PatchId{12}};
  const auto exact = exact_relative_covariances(map.graph, map.truth, PatchId{5}, near);
  const auto local = local_relative_covariance(map.graph, map.truth, PatchId{5}, PatchId{12}, 20);
  ASSERT_TRUE(local && exact.size() == 1);
  EXPECT_GE(local->trace(), exact[0].trace() * (1 - 1e-9));
}

TEST(RelativeCovariance, OfOnePatchOnAnotherIslandIsNothing) {
  SmallMap map(4);
  map.graph.add(relation(0, 1, RelativePose{{1, 0, 0}, some_information}));
  map.graph.add(relation(2, 3, RelativePose{{1, 0, 0}, some_information}));
  EXPECT_FALSE(local_relative_covariance(map.graph, map.truth, PatchId{0}, PatchId{3}, 10));
}

TEST(WellDetermined, TestsTheLongerAxisOfTheEllipse) {
  const ConfidenceThreshold threshold{0.5, 0.1};
  const double limit = 0.5 / 1.96;
  const auto ellipse = [](double longer, double yaw, double sigma_yaw) {
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    const Eigen::Matrix2d turn = Eigen::Rotation2Dd(yaw).toRotationMatrix();
    covariance.topLeftCorner<2, 2>() =
        turn * Eigen::Vector2d(longer * longer, 1e-4).asDiagonal() * turn.transpose();
    covariance(2, 2) = sigma_yaw * sigma_yaw;
    return covariance;
  };
  for (const double yaw : {0.0, 0.7, 1.5, 2.4}) {
    EXPECT_TRUE(well_determined(ellipse(0.999 * limit, yaw, 0.01), threshold));
    EXPECT_FALSE(well_determined(ellipse(1.001 * limit, yaw, 0.01), threshold));
    EXPECT_FALSE(well_determined(ellipse(0.5 * limit, yaw, 0.052), threshold));
  }
}

}  // namespace
}  // namespace isthmus
