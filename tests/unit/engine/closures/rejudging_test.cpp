// A robot's way of a dozen patches, a metre apart, that a closure has bent into a loop.

#include "server/engine/closures/rejudging.hpp"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <algorithm>

namespace isthmus {
namespace {

Relation pose_relation(int a, int b, const Pose& a_from_b, const Origin& origin, RelationKind kind) {
  Relation relation;
  relation.a = PatchId{a};
  relation.b = PatchId{b};
  relation.kind = kind;
  relation.origin = origin;
  const Eigen::Vector3d sigmas(0.03, 0.03, 0.01);
  relation.measurement =
      RelativePose{a_from_b, Eigen::Matrix3d(sigmas.cwiseProduct(sigmas).cwiseInverse().asDiagonal())};
  return relation;
}

Relation match(int a, int b, const Pose& a_from_b) {
  return pose_relation(a, b, a_from_b, {OriginKind::match, {}}, RelationKind::point_to_line);
}

constexpr ClosureId bending_closure{3};

/// Closure 3 says that patch 11 lies beside patch 0.
Map bent_way() {
  Map map;
  for (int i = 0; i < 12; ++i) {
    auto patch = std::make_shared<Patch>();
    patch->id = PatchId{i};
    map.add(patch, {1.0 * i, 0, 0});
    if (i > 0)
      map.relate(pose_relation(i - 1, i, {1, 0, 0}, {OriginKind::odometry, {}}, RelationKind::odometry));
  }
  map.relate(pose_relation(0, 11, {0, 1, 3.1}, {OriginKind::hypothesis, bending_closure},
                           RelationKind::point_to_line));
  map.refit_island(PatchId{0});
  return map;
}

std::vector<RelationId> gone_without(const Map& map) {
  const Rejudging judged(map, Dependencies(map.graph()), {bending_closure}, EngineOptions{});
  std::vector<RelationId> gone;
  for (const Relation& relation : judged.gone()) gone.push_back(relation.id);
  return gone;
}

TEST(Rejudging, OnlyWhatDependsOnTheClosureIsJudged) {
  Map map = bent_way();
  const RelationId own{11};
  map.relate(match(4, 6, {9, 9, 2}));  // nonsense, but made without the closure
  EXPECT_EQ(gone_without(map), std::vector<RelationId>{own});
}

TEST(Rejudging, WhatAgreesWithTheMapThatIsLeftStaysAndWhatDoesNotGoes) {
  Map map = bent_way();
  const RelationId bent = map.relate(match(1, 10, {0, 1, 3.1}));     // as the closure has it
  const RelationId straight = map.relate(match(1, 11, {10, 0, 0}));  // as the way was
  const std::vector<RelationId> gone = gone_without(map);
  EXPECT_TRUE(std::ranges::count(gone, bent));
  EXPECT_FALSE(std::ranges::count(gone, straight));
}

TEST(Rejudging, WhatItsClosureAloneConnectedGoes) {
  Map map = bent_way();
  for (int i = 12; i < 14; ++i) {
    auto patch = std::make_shared<Patch>();
    patch->id = PatchId{i};
    map.add(patch, {1.0 * i, 0, 0});
  }
  map.relate(pose_relation(12, 13, {1, 0, 0}, {OriginKind::odometry, {}}, RelationKind::odometry));
  const RelationId joined = map.relate(
      pose_relation(2, 12, {0, 1, 0}, {OriginKind::sighting, bending_closure}, RelationKind::range));
  const RelationId across = map.relate(match(3, 13, {0, 1, 0}));
  const std::vector<RelationId> gone = gone_without(map);
  EXPECT_EQ(gone, (std::vector<RelationId>{RelationId{11}, joined, across}));
}

TEST(Rejudging, TheMapThatIsLeftIsFitted) {
  const Map map = bent_way();
  const Rejudging judged(map, Dependencies(map.graph()), {bending_closure}, EngineOptions{});
  const Manifold& manifold = judged.rest().manifold();
  EXPECT_NEAR(manifold.relative_pose(PatchId{0}, PatchId{11}).x, 11, 1e-6);
  EXPECT_TRUE(judged.changed().contains(PatchId{0}));
}

// (Λ⁻¹ + P)⁻¹ is what both errors leave.
TEST(ChiSquared, OfAMeasurementAgainstAMapCountsBothErrors) {
  RelativePose measured;
  measured.a_from_b = {1, 2, 0.3};
  measured.information = Eigen::Vector3d(100, 25, 400).asDiagonal();
  const Pose mapped{1.2, 1.7, 0.35};
  Eigen::Matrix3d covariance;
  covariance << 0.04, 0.01, 0, 0.01, 0.09, 0.002, 0, 0.002, 0.01;
  Eigen::Vector3d off = to_vector(mapped) - to_vector(measured.a_from_b);
  const double wanted = off.dot((measured.information.inverse() + covariance).inverse() * off);
  EXPECT_NEAR(chi_squared(measured, mapped, covariance), wanted, 1e-6 * wanted);
}

}  // namespace
}  // namespace isthmus
