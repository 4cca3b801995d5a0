#include "server/feature_maps/meeting/placement.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace isthmus {
namespace {

constexpr double inf = std::numeric_limits<double>::infinity();
const Pose truth{3, -2, 1.1};  // one_from_two

/// A robot at `observer` sees one at `target`, each in the world of the first map.
struct Seeing {
  Pose observer;
  Eigen::Vector2d target;
  bool from_one = true;
  int encounter = 0;
  double range_sigma_m = 0.05;
  double bearing_sigma_rad = 0.02;
};

Clue clue_of(const Seeing& seeing) {
  Clue clue;
  clue.kind = seeing.from_one ? ClueKind::seen_from_one : ClueKind::seen_from_two;
  clue.encounter = seeing.encounter;
  clue.observer = seeing.from_one ? seeing.observer : inverse(truth) * seeing.observer;
  clue.target = seeing.from_one ? inverse(truth) * seeing.target : seeing.target;
  const Eigen::Vector2d in_robot = inverse(seeing.observer) * seeing.target;
  clue.range_m = in_robot.norm();
  clue.bearing_rad = std::atan2(in_robot.y(), in_robot.x());
  clue.range_sigma_m = seeing.range_sigma_m;
  clue.bearing_sigma_rad = seeing.bearing_sigma_rad;
  return clue;
}

void expect_true(const std::optional<MapPlacement>& placement, double within = 1e-3) {
  ASSERT_TRUE(placement);
  const Eigen::Vector3d off = wrapped_difference(placement->one_from_two, truth);
  EXPECT_LT(off.cwiseAbs().maxCoeff(), within);
}

/// Two robots that see one another, from other places each time.
std::vector<Clue> meetings(int count) {
  std::vector<Clue> clues;
  for (int i = 0; i < count; ++i) {
    const Pose one{0.8 * i, 0.5 * i, 0.3 * i}, two{4 - 0.3 * i, 2 + 0.7 * i, 2 - 0.5 * i};
    clues.push_back(clue_of({one, position(two), true, i}));
    clues.push_back(clue_of({two, position(one), false, i}));
  }
  return clues;
}

/// Only one robot sees the other.
std::vector<Clue> one_way(int count, double range_sigma_m = 0.05, double bearing_sigma_rad = 0.02) {
  std::vector<Clue> clues;
  for (int i = 0; i < count; ++i)
    clues.push_back(clue_of({{0.9 * i, 1.1 * std::sin(2.0 * i), 0.4 * i},
                             {4 + 1.5 * std::cos(1.7 * i), 2 + 2.0 * std::sin(1.1 * i)},
                             true,
                             i,
                             range_sigma_m,
                             bearing_sigma_rad}));
  return clues;
}

TEST(Placement, AMeetingTellsWhereButAFurtherOneThatItIsTrue) {
  const auto one = best_placement(meetings(1), {});
  expect_true(one);
  EXPECT_GT(one->log_odds, 0);
  EXPECT_LT(one->log_odds, 7);
  const auto two = best_placement(meetings(2), {});
  expect_true(two);
  EXPECT_GT(two->log_odds, 7);
}

TEST(Placement, SightingsOfOneRobotByTheOtherAlignMapsInTheEnd) {
  EXPECT_FALSE(best_placement(one_way(1), {}));  // no heading
  const auto two = best_placement(one_way(2), {});
  expect_true(two);
  EXPECT_LT(two->log_odds, 7);
  const auto four = best_placement(one_way(4), {});
  expect_true(four);
  EXPECT_GT(four->log_odds, 7);
}

TEST(Placement, RangesAloneAlignMapsAndSoDoBearings) {
  const auto ranges = best_placement(one_way(8, 0.05, inf), {});
  expect_true(ranges);
  EXPECT_GT(ranges->log_odds, 7);
  const auto bearings = best_placement(one_way(8, inf, 0.02), {});
  expect_true(bearings);
  EXPECT_GT(bearings->log_odds, 7);
}

TEST(Placement, AHundredSightingsOfAStandingRobotTellNoHeading) {
  std::vector<Clue> clues;
  for (int i = 0; i < 40; ++i) clues.push_back(clue_of({{0, 0, 0.3}, {4, 2}, true, i}));
  EXPECT_FALSE(best_placement(clues, {}));
  // One more, false, would turn the map about that place: the odds are those of that one.
  Clue wrong = clue_of({{0, 0, 0.3}, {5, 4}, true, 40});
  wrong.bearing_rad += 1.5;
  clues.push_back(wrong);
  const auto placement = best_placement(clues, {});
  EXPECT_TRUE(!placement || placement->log_odds < 7);
}

TEST(Placement, BarcodesThatBothMapsKnowTellTheMoreTheMoreTheyAre) {
  std::vector<Clue> tags;
  const std::vector<Eigen::Vector2d> places = {{1, 1}, {4, 0}, {2, 5}, {-1, 3}};
  for (const Eigen::Vector2d& place : places) {
    Clue tag;
    tag.kind = ClueKind::same_place;
    tag.encounter = -1 - static_cast<int>(tags.size());
    tag.place = place;
    tag.target = inverse(truth) * place;
    tag.place_covariance = tag.target_covariance = 0.0009 * Eigen::Matrix2d::Identity();
    tags.push_back(tag);
  }
  EXPECT_FALSE(best_placement(std::span(tags).first(1), {}));
  const auto placement = best_placement(tags, {});
  EXPECT_LT(best_placement(std::span(tags).first(2), {})->log_odds, placement->log_odds - 10);
  expect_true(placement);
  EXPECT_GT(placement->log_odds, 7);
}

TEST(Placement, FalseSightingsAmongTrueOnesDoNotMoveIt) {
  std::vector<Clue> clues = meetings(3);
  for (int i = 0; i < 3; ++i) {
    Clue wrong = clue_of({{1.0 * i, 0, 0}, {3, 3}, true, 10 + i});
    wrong.bearing_rad = 2.0 - 1.3 * i;
    wrong.range_m = 2 + i;
    clues.push_back(wrong);
  }
  const auto placement = best_placement(clues, {});
  expect_true(placement);
  EXPECT_GT(placement->log_odds, 7);
  EXPECT_EQ(placement->agreeing.size(), 6u);
}

TEST(Placement, FalseSightingsAloneAreHardlyEverBelieved) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(0, 1);
  int believed = 0;
  for (int run = 0; run < 300; ++run) {
    std::vector<Clue> clues = one_way(4);
    for (Clue& clue : clues) {
      clue.range_m = 0.5 + 11 * share(random);
      clue.bearing_rad = 2 * std::numbers::pi * share(random) - std::numbers::pi;
    }
    const auto placement = best_placement(clues, {});
    if (placement && placement->log_odds > 7) ++believed;
  }
  EXPECT_LE(believed, 3);  // of encounters of which all are false, a hundredth
}

TEST(Placement, ItErrsAsItSays) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  double sum = 0;
  constexpr int runs = 400;
  for (int run = 0; run < runs; ++run) {
    std::vector<Clue> clues = meetings(2);
    for (Clue& clue : clues) {
      clue.range_m += clue.range_sigma_m * normal(random);
      clue.bearing_rad += clue.bearing_sigma_rad * normal(random);
    }
    const auto placement = best_placement(clues, {});
    ASSERT_TRUE(placement);
    const Eigen::Vector3d off = wrapped_difference(truth, placement->one_from_two);
    sum += off.dot(placement->covariance.inverse() * off) / 3 / runs;
  }
  EXPECT_NEAR(sum, 1, 0.15);
}

}  // namespace
}  // namespace isthmus
