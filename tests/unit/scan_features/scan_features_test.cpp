#include "scanmatch/features/scan_features.hpp"

#include <gtest/gtest.h>

#include "tests/support/noisy_scan.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

ScanFeatureOptions exact() {
  ScanFeatureOptions options;
  options.noise = {0.003, 0.003, 0};
  return options;
}

ScanFeatures seen(const Walls& walls, const Pose& pose, NoisyLaser laser = {}) {
  std::mt19937 random(1);
  return find_features(laser.scan(walls, pose, random), laser.laser(), exact());
}

const ScanSegment* nearest_to(ScanFeatures&&,
                              const Eigen::Vector2d&) = delete;  // it would not outlive the call

const ScanSegment* nearest_to(const ScanFeatures& features, const Eigen::Vector2d& point) {
  const ScanSegment* nearest = nullptr;
  double least = 1e9;
  for (const ScanSegment& segment : features.segments) {
    const Feature& f = segment.observed.feature;
    const double distance = (0.5 * (f.a + f.b) - point).norm();
    if (distance < least) {
      least = distance;
      nearest = &segment;
    }
  }
  return nearest;
}

TEST(ScanFeatures, AWallEndsInBothCornersOfTheRoom) {
  Walls room;
  add_box(room, -3, -2, 4, 2);
  const ScanFeatures features = seen(room, {});
  ASSERT_EQ(features.segments.size(), 3U);
  const ScanSegment& ahead = features.segments[1];
  EXPECT_EQ(ahead.end_a, EndKind::corner);
  EXPECT_EQ(ahead.end_b, EndKind::corner);
  EXPECT_EQ(dimension(ahead.observed.feature), 4);
  EXPECT_NEAR((ahead.observed.feature.a - Eigen::Vector2d(4, -2)).norm(), 0, 1e-4);
  EXPECT_NEAR((ahead.observed.feature.b - Eigen::Vector2d(4, 2)).norm(), 0, 1e-4);
  EXPECT_EQ(features.segments[0].end_a, EndKind::view_edge);
  EXPECT_EQ(features.segments[0].end_b, EndKind::corner);
  EXPECT_EQ(dimension(features.segments[0].observed.feature), 3);
}

TEST(ScanFeatures, ADoorwaysPostIsAnEdge) {
  const Walls walls{{{3, -4}, {3, 1}}, {{6, -9}, {6, 9}}};
  const ScanFeatures features = seen(walls, {});
  const ScanSegment* near = nearest_to(features, {3, -1.5});
  ASSERT_NE(near, nullptr);
  EXPECT_EQ(near->end_b, EndKind::edge);
  EXPECT_NEAR(near->observed.feature.b.y(), 1, 0.06);
  const double sigma = std::sqrt(
      near->observed.covariance(near->observed.covariance.rows() - 1, near->observed.covariance.rows() - 1));
  EXPECT_GT(sigma, 0.01);  // somewhere between two beams, 6 cm apart
  EXPECT_LT(sigma, 0.04);
}

TEST(ScanFeatures, AWallThatSomethingHidesIsCutOff) {
  Walls walls{{{6, -9}, {6, 9}}};
  add_box(walls, 3, 0, 3.5, 0.5);
  const ScanFeatures features = seen(walls, {});
  const ScanSegment* right = nearest_to(features, {6, -4});
  ASSERT_NE(right, nullptr);
  EXPECT_EQ(right->end_b, EndKind::occluded);
  EXPECT_FALSE(right->observed.feature.end_b_known);
}

TEST(ScanFeatures, AWallBeyondTheRangeIsCutOff) {
  NoisyLaser laser;
  laser.range_max_m = 5;
  const ScanFeatures features = seen({{{2, -50}, {2, 50}}}, {}, laser);
  ASSERT_EQ(features.segments.size(), 1U);
  EXPECT_EQ(features.segments[0].end_a, EndKind::range_limit);
  EXPECT_EQ(features.segments[0].end_b, EndKind::range_limit);
  EXPECT_EQ(dimension(features.segments[0].observed.feature), 2);
}

TEST(ScanFeatures, NoReturnBesideAWallIsNoEdge) {
  const ScanFeatures features = seen({{{3, -1}, {3, 1}}}, {});
  ASSERT_EQ(features.segments.size(), 1U);
  EXPECT_EQ(features.segments[0].end_a, EndKind::unknown);
  EXPECT_EQ(features.segments[0].end_b, EndKind::unknown);
}

TEST(ScanFeatures, CornersTellTheirFreeSide) {
  Walls walls;
  add_box(walls, -8, -4, 8, 4);
  const ScanFeatures inside = seen(walls, {4, 0, 0});
  ASSERT_EQ(inside.corners.size(), 2U);
  EXPECT_NEAR(inside.corners[1].feature.opening_rad, 0.5 * std::numbers::pi, 1e-3);
  EXPECT_NEAR((inside.corners[1].feature.a - Eigen::Vector2d(4, 4)).norm(), 0, 1e-3);
  const Eigen::Vector2d bisector = along(inside.corners[1].feature);
  EXPECT_NEAR((bisector - Eigen::Vector2d(-1, -1).normalized()).norm(), 0, 1e-3);

  const ScanFeatures outside = seen({{{3, 0}, {5, -2}}, {{3, 0}, {5, 2}}}, {});
  ASSERT_EQ(outside.corners.size(), 1U);
  EXPECT_NEAR(outside.corners[0].feature.opening_rad, 1.5 * std::numbers::pi, 1e-3);
  EXPECT_NEAR((along(outside.corners[0].feature) - Eigen::Vector2d(-1, 0)).norm(), 0, 1e-3);
}

TEST(ScanFeatures, AColumnIsAPoleAndABoxIsNot) {
  Walls walls;
  add_box(walls, -8, -6, 8, 6);
  add_pillar(walls, {3, 1}, 0.25);
  add_box(walls, 3, -1.5, 3.4, -1.1);
  NoisyLaser laser;
  laser.beams = 541;
  const ScanFeatures features = seen(walls, {}, laser);
  ASSERT_EQ(features.poles.size(), 1U);
  EXPECT_NEAR((features.poles[0].feature.a - Eigen::Vector2d(3, 1)).norm(), 0, 0.01);
  EXPECT_NEAR(features.poles[0].feature.radius_m, 0.25, 0.01);
  EXPECT_TRUE(features.poles[0].feature.radius_known);
}

TEST(ScanFeatures, TheSameWallsAreFoundFrom90To1081Beams) {
  for (const int beams : {90, 180, 361, 541, 1081}) {
    NoisyLaser laser;
    laser.beams = beams;
    laser.range_sigma_m = laser.bearing_sigma_rad = 0.003;
    Walls room;
    add_box(room, -3, -2, 4, 2);
    const ScanFeatures features = seen(room, {0, 0.3, 0.1}, laser);
    EXPECT_EQ(features.segments.size(), 3U) << beams;
    EXPECT_EQ(features.corners.size(), 2U) << beams;
  }
}

TEST(ScanFeatures, ALaserThatTurnsTheOtherWaySeesTheSame) {
  std::mt19937 random(1);
  const NoisyLaser laser;
  Scan scan = laser.scan(furnished_room(), {0.3, -0.5, 0.2}, random);
  const ScanFeatures one = find_features(scan, laser.laser(), exact());
  std::reverse(scan.ranges_m.begin(), scan.ranges_m.end());
  scan.bearing0_rad *= -1;
  scan.bearing_step_rad *= -1;
  const ScanFeatures other = find_features(scan, laser.laser(), exact());
  ASSERT_EQ(one.segments.size(), other.segments.size());
  for (std::size_t i = 0; i < one.segments.size(); ++i)
    EXPECT_TRUE(one.segments[i].observed.feature.a.isApprox(other.segments[i].observed.feature.a, 1e-9));
}

TEST(ScanFeatures, AScanWithoutReturnsHasNone) {
  const ScanFeatures features = seen({}, {});
  EXPECT_TRUE(features.segments.empty() && features.corners.empty() && features.poles.empty());
}

}  // namespace
}  // namespace isthmus
