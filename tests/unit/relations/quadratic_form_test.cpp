#include "relations/quadratic_form.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/unit/relations/small_maps.hpp"

namespace isthmus {
namespace {

using namespace small_maps;

TEST(QuadraticForm, OfNoRowsCostsNothing) {
  const QuadraticForm form = QuadraticFormBuilder().build();
  EXPECT_EQ(form.cost({1, 2, 3}), 0);
  EXPECT_EQ(form.information({1, 2, 3}), Eigen::Matrix3d::Zero());
}

TEST(QuadraticForm, PointOnLineIsTheSquaredDistanceOverTwoVariances) {
  QuadraticFormBuilder builder;
  builder.point_on_line({1, 0}, {0, 0}, {0.6, 0.8}, 0.5);
  const Pose a_from_b{3, 3, 0};  // the point comes to lie at (4, 3), 4.8 m from the line
  EXPECT_EQ(builder.rows(), 1);
  EXPECT_NEAR(builder.build().cost(a_from_b), 4.8 * 4.8 / (2 * 0.25), 1e-12);
}

TEST(QuadraticForm, MinimumOfExactPointsIsTheTruth) {
  std::mt19937 random(1);
  const Pose truth{1.5, -2, 2.8};
  const QuadraticForm form = correspondences(points_on_walls(random, truth, 40, {0, 1.5}, 0)).form;
  const QuadraticForm::Minimum near = form.minimum(truth * Pose{0.4, -0.3, 0.3});
  EXPECT_LT(distance(near.a_from_b, truth), 1e-9);
  EXPECT_LT(near.cost, 1e-16);
  EXPECT_LT(distance(form.least().a_from_b, truth), 1e-9);
}

TEST(QuadraticForm, MinimumIsFoundFromBesideTheMaximum) {
  std::mt19937 random(1);
  const Pose truth{1.5, -2, 0.8};
  QuadraticFormBuilder builder;
  std::uniform_real_distribution<double> metres(-5, 5);
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector2d point(metres(random), metres(random));
    builder.point_on_line(point, truth * point, {1, 0}, 0.1);
    builder.point_on_line(point, truth * point, {0, 1}, 0.1);
  }
  const QuadraticForm form = builder.build();
  for (const double off : {1e-2, 1e-4, 1e-6}) {
    const Pose start{0, 0, truth.yaw + std::numbers::pi - off};
    EXPECT_LT(distance(form.minimum(start).a_from_b, truth), 1e-9) << off;
  }
}

TEST(QuadraticForm, MinimumInACorridorLeavesThePlaceAlongItAtTheStart) {
  std::mt19937 random(2);
  const Pose truth{0, 0.2, 0.1};
  const QuadraticForm form = correspondences(points_on_walls(random, truth, 40, {0}, 0)).form;
  const Pose found = form.minimum({7, 0, 0}).a_from_b;
  EXPECT_NEAR(found.x, 7, 1e-9);
  EXPECT_NEAR(found.y, truth.y, 1e-9);
  EXPECT_NEAR(found.yaw, truth.yaw, 1e-9);
  EXPECT_LT(form.information(truth)(0, 0), 1e-9 * form.information(truth)(1, 1));
}

// Along a corridor of 10,000 beams a single one is little, but it says where along.
TEST(QuadraticForm, MinimumFollowsTheFewestBeamsAlongACorridorButNotRounding) {
  const Pose truth{0.7, 0.2, 0.1};
  for (const auto& [sigma_m, said] : {std::pair{0.03, true}, {1e5, true}, {1e12, false}}) {
    QuadraticFormBuilder builder;
    for (int i = 0; i < 10'000; ++i) {
      const Eigen::Vector2d point(0.001 * i, i % 2 == 0 ? -1 : 1);
      builder.point_on_line(point, truth * point, {0, 1}, 0.03);
    }
    builder.point_on_line({3, 0}, truth * Eigen::Vector2d(3, 0), {1, 0}, sigma_m);
    const Pose found = builder.build().minimum({7, 0, 0}).a_from_b;
    EXPECT_NEAR(found.x, said ? truth.x : 7, 1e-4) << sigma_m;
    EXPECT_NEAR(found.y, truth.y, 1e-9);
    EXPECT_NEAR(found.yaw, truth.yaw, 1e-9);
  }
}

TEST(QuadraticForm, LeastCostIsNotAboveTheCostAnywhere) {
  std::mt19937 random(3);
  const QuadraticForm form = correspondences(points_on_walls(random, {1, 1, -2}, 30, {0.2, 1.5}, 0.2)).form;
  const double least = form.least().cost;
  for (int i = 0; i < 500; ++i) EXPECT_GE(form.minimum(random_pose(random)).cost, least * (1 - 1e-12));
  EXPECT_GT(least, 0.1);
}

}  // namespace
}  // namespace isthmus
