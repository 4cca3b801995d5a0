#include "server/engine/sightings/evidence.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "relations/confidence.hpp"
#include "tests/support/unmeasured.hpp"
#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

constexpr double floor_m = 0.05;  // what stamps, mounts and odometry leave open
constexpr double floor_rad = 0.03;
constexpr double correlation = 2;  // on sigmas: successive sightings err together

// Two patches on islands of their own, and a tag.
Map two_patches_and_a_tag() {
  Map map;
  map.add(patch_from(furnished_room(), PatchId{0}, {}), {2, 1, 0.5});
  map.add(patch_from(furnished_room(), PatchId{1}, {}), {-3, 4, -1.2});
  map.add(make_tag_patch(PatchId{2}, 50, 7), {5, 5, 0});
  return map;
}

PastPlace in_patch(int patch, const Pose& patch_from_robot) {
  PastPlace place;
  place.pose = {PatchId{patch}, patch_from_robot};
  return place;
}

Evidence evidence(double range_m, double range_sigma_m, double bearing_rad, double bearing_sigma_rad) {
  Evidence made;
  made.sighting = {"R1", 1'000'000, 2, range_m, range_sigma_m, bearing_rad, bearing_sigma_rad};
  made.observer = in_patch(0, {0.4, -0.3, 0.7});
  made.target_place = in_patch(1, {1.1, 0.6, -2});
  return made;
}

TEST(SightingRelation, RangeWithBearingPutsTheTargetWhereItWasMeasured) {
  const Map map = two_patches_and_a_tag();
  Evidence seen = evidence(3, 0.1, 0.4, 0.05);
  seen.record = 31;
  const auto relation = sighting_relation(map, seen, ClosureId{7}, {}, {});
  ASSERT_TRUE(relation);
  EXPECT_EQ(relation->a, PatchId{0});
  EXPECT_EQ(relation->b, PatchId{1});
  EXPECT_EQ(relation->kind, RelationKind::range_bearing);
  EXPECT_EQ(relation->origin, (Origin{OriginKind::sighting, ClosureId{7}, 31}));
  EXPECT_GT(relation->robust_scale, 0);

  const Pose least = minimiser(relation->measurement, {1, 1, 0.3});
  const Eigen::Vector2d target = least * position(seen.target_place->pose.patch_from_object);
  const Eigen::Vector2d wanted =
      seen.observer.pose.patch_from_object * Eigen::Vector2d(3 * std::cos(0.4), 3 * std::sin(0.4));
  EXPECT_NEAR((target - wanted).norm(), 0, 1e-9);
  EXPECT_NEAR(cost(relation->measurement, least), 0, 1e-9);
}

// Along the line of sight sigma is that of the range, across it that of the bearing at the measured range.
TEST(SightingRelation, CovarianceLiesAlongAndAcrossTheLineOfSight) {
  const Map map = two_patches_and_a_tag();
  Evidence seen = evidence(3, 0.1, 0.4, 0.05);
  seen.observer.covariance = Eigen::Vector3d(0.01, 0.01, 0.0004).asDiagonal();
  seen.target_place->covariance = Eigen::Vector3d(0.02, 0.02, 1).asDiagonal();
  const auto relation = sighting_relation(map, seen, {}, {}, {});
  ASSERT_TRUE(relation);
  const Pose least = minimiser(relation->measurement, {1, 1, 0.3});
  const double line_of_sight = seen.observer.pose.patch_from_object.yaw + 0.4;
  const auto cost_off_by = [&](const Eigen::Vector2d& off) {
    return cost(relation->measurement, Pose{off.x(), off.y(), 0} * least);
  };
  const double variance = 0.02 + 0.01 + floor_m * floor_m;
  const double along_variance = correlation * correlation * (0.01 + variance);
  const double across_variance =
      correlation * correlation * (9 * (0.0025 + 0.0004 + floor_rad * floor_rad) + variance);
  EXPECT_NEAR(cost_off_by(rotate(line_of_sight, {0.2, 0})), 0.5 * 0.04 / along_variance, 1e-9);
  EXPECT_NEAR(cost_off_by(rotate(line_of_sight, {0, 0.2})), 0.5 * 0.04 / across_variance, 1e-9);
  EXPECT_NEAR(cost_off_by(rotate(line_of_sight, {0.2, 0.2})),
              0.5 * 0.04 / along_variance + 0.5 * 0.04 / across_variance, 1e-9);
}

// It says where the target's origin is, nothing of where it looks: the patch may turn about the target.
TEST(SightingRelation, LeavesTheTargetsHeadingOpen) {
  const Map map = two_patches_and_a_tag();
  const Evidence seen = evidence(3, 0.1, 0.4, 0.05);
  const auto relation = sighting_relation(map, seen, {}, {}, {});
  ASSERT_TRUE(relation);
  const Pose least = minimiser(relation->measurement, {1, 1, 0.3});
  const Eigen::Vector2d in_b = position(seen.target_place->pose.patch_from_object);
  const Pose about_target = Pose{in_b.x(), in_b.y(), 1.3} * inverse(Pose{in_b.x(), in_b.y(), 0});
  EXPECT_NEAR(cost(relation->measurement, least * about_target), 0, 1e-9);
}

TEST(SightingRelation, RangeAloneAndBearingAloneAreThemselves) {
  const Map map = two_patches_and_a_tag();
  const auto ranged = sighting_relation(map, evidence(3, 0.1, 0, unmeasured), {}, {}, {});
  ASSERT_TRUE(ranged);
  EXPECT_EQ(ranged->kind, RelationKind::range);
  const Range& range = std::get<Range>(ranged->measurement);
  EXPECT_EQ(range.point_a, Eigen::Vector2d(0.4, -0.3));
  EXPECT_EQ(range.point_b, Eigen::Vector2d(1.1, 0.6));
  EXPECT_EQ(range.range_m, 3);
  EXPECT_NEAR(range.sigma_m, correlation * std::hypot(0.1, floor_m), 1e-12);

  const auto turned = sighting_relation(map, evidence(0, unmeasured, -0.8, 0.05), {}, {}, {});
  ASSERT_TRUE(turned);
  EXPECT_EQ(turned->kind, RelationKind::bearing);
  const Bearing& bearing = std::get<Bearing>(turned->measurement);
  EXPECT_EQ(bearing.a_from_observer, (Pose{0.4, -0.3, 0.7}));
  EXPECT_EQ(bearing.bearing_rad, -0.8);
  EXPECT_GT(bearing.sigma_rad, correlation * std::hypot(0.05, floor_rad));
}

TEST(SightingRelation, OfBothEndsOnOnePatchIsNone) {
  const Map map = two_patches_and_a_tag();
  Evidence seen = evidence(3, 0.1, 0.4, 0.05);
  seen.target_place = in_patch(0, {1, 1, 0});
  EXPECT_FALSE(sighting_relation(map, seen, {}, {}, {}));
}

// A tag's yaw means nothing, but a fit needs one. A tag is placed by two sightings or more.
TEST(SightingRelation, ATagGetsAWeakYawSoThatItsPlaceIsDetermined) {
  Map map = two_patches_and_a_tag();
  Evidence seen = evidence(3, 0.1, 0.4, 0.05);
  seen.is_tag = true;
  seen.target_place = in_patch(2, {});
  const auto relation = sighting_relation(map, seen, {}, {}, {});
  ASSERT_TRUE(relation);
  const Eigen::Vector2d at =
      seen.observer.pose.patch_from_object * Eigen::Vector2d(3 * std::cos(0.4), 3 * std::sin(0.4));
  const Pose a_from_tag{at.x(), at.y(), 0};
  EXPECT_NEAR(cost(relation->measurement, a_from_tag), 0, 1e-9);
  const Eigen::Matrix3d weight = information(relation->measurement, a_from_tag);
  EXPECT_GT(weight(2, 2), 0);
  EXPECT_LT(weight(2, 2), 1e-3);
  map.relate(*relation);
  map.relate(*relation);
  const std::vector<Pose> poses{{}, {}, a_from_tag};
  const auto covariance = local_relative_covariance(map.graph(), poses, PatchId{0}, PatchId{2}, 10);
  ASSERT_TRUE(covariance);
  const double along = 0.1 * 0.1 + floor_m * floor_m;
  const double across = 9 * (0.05 * 0.05 + floor_rad * floor_rad) + floor_m * floor_m;
  EXPECT_NEAR((*covariance)(0, 0) + (*covariance)(1, 1), correlation * correlation * (along + across) / 2,
              1e-9);
}

TEST(ProjectedSighting, OfAnEvidenceIsTheSightingBetweenItsProjectedEnds) {
  const Map map = two_patches_and_a_tag();
  Evidence seen = evidence(3, 0.1, 0.4, 0.05);
  seen.target_place->covariance = Eigen::Vector3d(0.02, 0.04, 1).asDiagonal();
  const ProjectedSighting projected = project_sighting(map, seen);
  EXPECT_EQ(projected.plane_from_observer, (Pose{2, 1, 0.5} * Pose{0.4, -0.3, 0.7}));
  const Pose target = Pose{-3, 4, -1.2} * Pose{1.1, 0.6, -2};
  EXPECT_NEAR((projected.target - position(target)).norm(), 0, 1e-12);
  EXPECT_NEAR(projected.target_variance, 0.03, 1e-12);
  EXPECT_EQ(projected.range_m, 3);
  EXPECT_EQ(projected.bearing_rad, 0.4);
  EXPECT_TRUE(projected.has_range() && projected.has_bearing());
}

// The covariance of an observer is kept in its patch's axes, and needed in the observer's own.
TEST(ProjectedSighting, TurnsTheObserversCovarianceIntoItsOwnAxes) {
  const Map map = two_patches_and_a_tag();
  Evidence seen = evidence(3, 0.1, 0.4, 0.05);
  seen.observer.pose.patch_from_object.yaw = 0.5 * M_PI;
  seen.observer.covariance = Eigen::Vector3d(0.09, 0.01, 0.001).asDiagonal();
  const ProjectedSighting projected = project_sighting(map, seen);
  EXPECT_NEAR(projected.observer_covariance(0, 0), 0.01, 1e-12);
  EXPECT_NEAR(projected.observer_covariance(1, 1), 0.09, 1e-12);
  EXPECT_NEAR(projected.observer_covariance(2, 2), 0.001, 1e-12);
}

TEST(MeasuredPoint, NeedsRangeAndBearing) {
  const Map map = two_patches_and_a_tag();
  const auto point = measured_point(map, evidence(2, 0.1, 0.5, 0.05));
  ASSERT_TRUE(point);
  const Pose from = Pose{2, 1, 0.5} * Pose{0.4, -0.3, 0.7};
  EXPECT_NEAR((*point - (position(from) + rotate(from.yaw + 0.5, {2, 0}))).norm(), 0, 1e-12);
  EXPECT_FALSE(measured_point(map, evidence(2, 0.1, 0, unmeasured)));
  EXPECT_FALSE(measured_point(map, evidence(0, unmeasured, 0.5, 0.05)));
}

// Sightings of a tag at (3, 2) in patch 0, which lies at the origin here.
class TagPool {
 public:
  TagPool() { map.add(patch_from(furnished_room(), PatchId{0}, {}), {}); }

  void see(const Pose& from, const Eigen::Vector2d& off = Eigen::Vector2d::Zero()) {
    const Eigen::Vector2d at = inverse(from) * (tag + off);
    Evidence seen = evidence(at.norm(), 0.05, std::atan2(at.y(), at.x()), 0.03);
    seen.target_place.reset();
    seen.observer = in_patch(0, from);
    members.push_back(pool.size());
    pool.push_back(seen);
  }
  PointConsensus agree() const { return agree_on_a_point(map, pool, members, {}); }

  const Eigen::Vector2d tag{3, 2};
  Map map;
  std::vector<Evidence> pool;
  std::vector<std::size_t> members;
};

TEST(AgreeOnAPoint, TwoFromPlacesApartAreEnoughAndTwoFromOneAreNot) {
  TagPool pool;
  pool.see({0, 0, 0.2});
  EXPECT_FALSE(pool.agree().enough({}));
  pool.see({0.1, 0, 0.3});
  EXPECT_EQ(pool.agree().supporters.size(), 2U);
  EXPECT_FALSE(pool.agree().enough({}));

  TagPool apart;
  apart.see({0, 0, 0.2});
  apart.see({1, -1, 1.2});
  const PointConsensus consensus = apart.agree();
  EXPECT_TRUE(consensus.enough({}));
  EXPECT_NEAR(consensus.apart_m, std::sqrt(2), 1e-9);
  EXPECT_NEAR((consensus.point - apart.tag).norm(), 0, 1e-9);
}

TEST(AgreeOnAPoint, ThreeFromOnePlaceAreEnough) {
  TagPool pool;
  for (int i = 0; i < 3; ++i) pool.see({0.05 * i, 0, 0.1 * i});
  EXPECT_TRUE(pool.agree().enough({}));
}

TEST(AgreeOnAPoint, WhatPutsItElsewhereDoesNotSupportNorMoveIt) {
  TagPool pool;
  pool.see({0, 0, 0.2});
  pool.see({0.5, -1, 1.2}, {2, -2});
  pool.see({1, -1, 1.2});
  pool.see({-1, 0, -0.4});
  pool.see({1, 0, -0.4}, {-2, 3});
  const PointConsensus consensus = pool.agree();
  EXPECT_EQ(consensus.supporters, (std::vector<std::size_t>{0, 2, 3}));
  EXPECT_NEAR((consensus.point - pool.tag).norm(), 0, 1e-9);
}

TEST(AgreeOnAPoint, RangesAloneSupportButSayNothingOfTheirOwn) {
  TagPool pool;
  pool.see({0, 0, 0.2});
  pool.see({1, -1, 1.2});
  pool.pool[1].sighting.bearing_sigma_rad = unmeasured;
  const PointConsensus consensus = pool.agree();
  EXPECT_EQ(consensus.supporters.size(), 2U);
  EXPECT_NEAR((consensus.point - pool.tag).norm(), 0, 1e-9);
  pool.pool[0].sighting.bearing_sigma_rad = unmeasured;
  EXPECT_TRUE(pool.agree().supporters.empty());
}

}  // namespace
}  // namespace isthmus
