#include "relations/relation.hpp"

#include <gtest/gtest.h>

#include "relations/residuals.hpp"
#include "tests/unit/relations/small_maps.hpp"

namespace isthmus {
namespace {

using namespace small_maps;

TEST(SquareRootInformation, OfACorrelatedInformationGivesItsQuadraticForm) {
  Eigen::Matrix3d information;
  information << 20, 7, -3, 7, 10, 4, -3, 4, 30;
  const Eigen::Vector3d r(0.3, -1.2, 0.7);
  EXPECT_NEAR((square_root_information(information) * r).squaredNorm(), r.dot(information * r), 1e-12);
}

TEST(SquareRootInformation, OfASingularInformationGivesItsQuadraticForm) {
  const Eigen::Vector3d direction(1, 2, -1);
  const Eigen::Matrix3d information = direction * direction.transpose();
  const Eigen::Vector3d r(0.3, -1.2, 0.7);
  EXPECT_NEAR((square_root_information(information) * r).squaredNorm(), r.dot(information * r), 1e-12);
}

TEST(Relation, RelativePoseCostsItsMahalanobisDistance) {
  std::mt19937 random(4);
  const Eigen::Matrix3d information = random_information(random);
  const Measurement measured = RelativePose{{1, 2, 3.1}, information};
  const Eigen::Vector3d difference(0.1, -0.2, 0.15);
  const Pose pose{1.1, 1.8, wrap_angle(3.25)};  // across the wrap of the angle
  EXPECT_NEAR(cost(measured, pose), 0.5 * difference.dot(information * difference), 1e-10);
}

TEST(Relation, RangeMeasuresTheDistanceOfTheTwoPoints) {
  const Measurement measured = Range{{1, 0}, {0, 1}, 4, 0.5};
  EXPECT_NEAR(cost(measured, {4, 3, 0}), 0.5 * 4, 1e-12);  // (4, 4) from (1, 0): 5 m, two sigma too far
}

TEST(Relation, BearingMeasuresTheDirectionFromTheObserver) {
  const Measurement measured = Bearing{{1, 1, std::numbers::pi / 2}, {0, 0}, 0.1, 0.05};
  EXPECT_NEAR(cost(measured, {1, 5, 2}), 0.5 * 4, 1e-12);  // straight ahead, two sigma to the right
}

TEST(Relation, RangeAndBearingOfCoincidingPointsStayFinite) {
  EXPECT_TRUE(information(Measurement(Range{{0, 0}, {0, 0}, 1, 0.1}), {0, 0, 0}).allFinite());
  EXPECT_TRUE(information(Measurement(Bearing{{0, 0, 0}, {0, 0}, 0, 0.1}), {0, 0, 0}).allFinite());
}

TEST(Relation, MinimiserOfEachKindCostsNothing) {
  std::mt19937 random(5);
  const Pose start{0.5, 0.4, 0.3};
  const Measurement kinds[] = {
      correspondences(points_on_walls(random, {0.6, 0.3, 0.2}, 20, {0, 1.5}, 0)),
      RelativePose{{1, 2, 3}, random_information(random)},
      Range{{1, 0}, {0, 1}, 4, 0.5},
      Bearing{{1, 1, 0.3}, {0.2, 0.1}, -2, 0.05},
  };
  for (const Measurement& measured : kinds) EXPECT_LT(cost(measured, minimiser(measured, start)), 1e-16);
}

TEST(Relation, RobustLossJudgesThePairAboveItsOwnMinimum) {
  std::mt19937 random(6);
  RelationGraph graph;
  graph.add_patch(PatchId{0});
  graph.add_patch(PatchId{1});
  Relation noisy = relation(0, 1, correspondences(points_on_walls(random, {1, 0, 0}, 200, {0, 1.5}, 0.3)));
  noisy.robust_scale = 2;
  const Relation& stored = *graph.find(graph.add(noisy));
  const Pose best = std::get<Correspondences>(stored.measurement).least.a_from_b;
  EXPECT_GT(cost(stored.measurement, best), 100);  // two hundred poor points
  EXPECT_NEAR(chi_squared(stored.measurement, best), 0, 1e-9);
  EXPECT_TRUE(information(stored, best).isApprox(information(stored.measurement, best), 1e-9));
  const Pose off = best * Pose{0.5, 0, 0};
  const double c = chi_squared(stored.measurement, off);
  EXPECT_NEAR(cost(stored, off), 0.5 * 4 * std::log(1 + c / 4), 1e-9 * c);
  EXPECT_TRUE(information(stored, off).isApprox(information(stored.measurement, off) / (1 + c / 4), 1e-12));
}

TEST(RobustWeight, IsTheDerivativeOfTheLoss) {
  EXPECT_EQ(robust_weight(1e6, 0), 1) << "no loss";
  for (const double scale : {0.5, 2.0, 7.0}) {
    EXPECT_EQ(robust_weight(0, scale), 1);
    EXPECT_NEAR(robust_weight(scale * scale, scale), 0.5, 1e-12);
    for (const double c : {0.1, 1.0, 10.0, 400.0}) {
      const auto loss = [&](double x) { return scale * scale * std::log1p(x / (scale * scale)); };
      const double h = 1e-4 * c;
      EXPECT_NEAR(robust_weight(c, scale), (loss(c + h) - loss(c - h)) / (2 * h), 1e-7);
    }
  }
}

TEST(Relation, NamesAreThoseOfTheEnumerators) {
  EXPECT_EQ(name(OriginKind::propagation), "propagation");
  EXPECT_EQ(name(RelationKind::range_bearing), "range_bearing");
}

TEST(Relation, CountsItsCorrespondences) {
  std::mt19937 random(7);
  EXPECT_EQ(count(relation(0, 1, correspondences(points_on_walls(random, {}, 12, {0}, 0)))), 12);
  EXPECT_EQ(count(relation(0, 1, Range{})), 1);
}

}  // namespace
}  // namespace isthmus
