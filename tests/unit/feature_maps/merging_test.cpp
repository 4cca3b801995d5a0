#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "server/feature_maps/merging/placing_judgement.hpp"
#include "server/feature_maps/merging/placing_search.hpp"
#include "tests/support/buildings.hpp"

namespace isthmus {
namespace {

using testing::Walls;

FreeView look(const Walls& walls, const Eigen::Vector2d& eye, const MergingOptions& options) {
  FreeView view{{eye.x(), eye.y(), 0}, std::vector<float>(options.view_sectors, 0)};
  for (std::size_t i = 0; i < view.hit_m.size(); ++i) {
    const double bearing =
        2 * std::numbers::pi * (static_cast<double>(i) + 0.5) / static_cast<double>(view.hit_m.size());
    view.hit_m[i] = static_cast<float>(std::min(30.0, testing::range_to(walls, eye, bearing)));
  }
  return view;
}

/// What a robot that looked from places of a building has of it, in a frame of its own: walls of a metre and
/// more that stand within `reach_m`, from the side on which they were seen.
MapSketch seen(const Walls& walls, const std::vector<Eigen::Vector2d>& places, const Pose& map_from_world,
               double reach_m = 6, const MergingOptions& options = {}) {
  FeatureState state;
  add_robot(state, {}, Eigen::Matrix3d::Zero());
  std::vector<FreeView> views;
  for (const auto& [from, to] : walls) {
    const Eigen::Vector2d middle = 0.5 * (from + to);
    for (const double side : {1.0, -1.0}) {
      const Eigen::Vector2d a = side > 0 ? from : to, b = side > 0 ? to : from;
      const Eigen::Vector2d front = quarter_turn(b - a).normalized();
      const bool is_seen = (to - from).norm() >= 1 &&
                           std::any_of(places.begin(), places.end(), [&](const Eigen::Vector2d& eye) {
                             const Eigen::Vector2d ray = middle + 0.05 * front - eye;
                             return ray.norm() < reach_m && front.dot(ray) < 0 &&
                                    testing::range_to(walls, eye, std::atan2(ray.y(), ray.x())) > ray.norm();
                           });
      if (!is_seen) continue;
      const Feature feature = segment_feature(map_from_world * a, map_from_world * b, true, true);
      add_feature(state, 0, {feature, 1e-4 * LocalMatrix::Identity(4, 4)});
    }
  }
  for (const Eigen::Vector2d& eye : places) {
    FreeView view = look(walls, eye, options);
    view.map_from_laser = map_from_world * view.map_from_laser;
    views.push_back(std::move(view));
  }
  return sketch_of(state, {0}, {&views}, options);
}

std::vector<Eigen::Vector2d> along(double from_x, double to_x, double y) {
  std::vector<Eigen::Vector2d> places;
  for (double x = from_x; x <= to_x; x += 0.5) places.emplace_back(x, y);
  return places;
}

const Pose one_from_world{-3, 1, 0.3}, two_from_world{7, -2, -2.1};
const Pose store_truth = one_from_world * inverse(two_from_world);

TEST(Merging, TwoMapsThatShareWallsAreLaidOverOneAnotherRight) {
  const Walls walls = testing::store_of_crates();
  const MapSketch one = seen(walls, along(1, 32, 6), one_from_world);
  const MapSketch two = seen(walls, along(16, 47, 6), two_from_world);
  const auto judged = judge_placings(one, two, {});
  ASSERT_TRUE(judged);
  EXPECT_GT(judged->log_odds, 7);
  EXPECT_NEAR(judged->best.one_from_two.x, store_truth.x, 0.02);
  EXPECT_NEAR(judged->best.one_from_two.y, store_truth.y, 0.02);
  EXPECT_NEAR(wrap_angle(judged->best.one_from_two.yaw - store_truth.yaw), 0, 0.002);
  EXPECT_EQ(judged->best.contradicted, 0);
  const std::vector<WallTwin> twins = surest_twins(one, judged->best, {});
  EXPECT_GE(twins.size(), 4U);
  for (const WallTwin& twin : twins) {
    const MapWall there = store_truth * two.walls[twin.two];
    EXPECT_LT((there.a - one.walls[twin.one].a).norm(), 0.05) << "another wall";
  }
}

TEST(Merging, TheSameMapsGiveTheSameAnswer) {
  const Walls walls = testing::store_of_crates();
  const MapSketch one = seen(walls, along(1, 32, 6), one_from_world);
  const MapSketch two = seen(walls, along(16, 47, 6), two_from_world);
  const auto first = judge_placings(one, two, {}), again = judge_placings(one, two, {});
  ASSERT_TRUE(first && again);
  EXPECT_EQ(first->best.one_from_two, again->best.one_from_two);
  EXPECT_EQ(first->log_odds, again->log_odds);
}

TEST(Merging, ACornerOfABuildingIsTooLittle) {
  const Walls walls = testing::store_of_crates();
  const auto judged = judge_placings(seen(walls, along(1, 20, 6), one_from_world),
                                     seen(walls, along(19, 47, 6), two_from_world), {});
  EXPECT_TRUE(!judged || judged->log_odds < 7);
}

/// Each has been in rooms of its own; or in the same ones, which nothing tells.
TEST(Merging, WhereRoomsRepeatNothingIsDecided) {
  const Walls walls = testing::alike_rooms();
  std::vector<Eigen::Vector2d> left = along(-2, 14, 4), right = along(22, 38, 4);
  for (const int room : {0, 1, 2, 3}) left.emplace_back(4 * room + 3.3, 7);
  for (const int room : {6, 7, 8, 9}) right.emplace_back(4 * room + 3.3, 7);
  MergingOptions trusting;  // nothing but other placings speaks against one
  trusting.against_any = trusting.beyond_share = 0;
  trusting.min_beyond = trusting.min_across = 0;
  const MapSketch one = seen(walls, left, one_from_world);
  for (const auto& places : {left, right}) {
    const MapSketch two = seen(walls, places, two_from_world);
    const std::vector<Pose> placings = propose_placings(one, two, {});
    ASSERT_FALSE(placings.empty());
    EXPECT_GE(account_of(one, two, refined_placing(one, two, placings.front(), {}), {}).explained, 12U)
        << "they look alike";
    for (const MergingOptions& options : {MergingOptions(), trusting}) {
      const auto judged = judge_placings(one, two, options);
      EXPECT_TRUE(!judged || judged->log_odds < 7);
    }
  }
}

/// Rooms and wings look alike: who knows nothing else may be in another one.
TEST(Merging, TwoMapsOfWhichNeitherGoesOnBeyondWhatTheyShareStayTwo) {
  const Walls walls = testing::store_of_crates();
  const MapSketch one = seen(walls, along(1, 47, 6), one_from_world);
  const MapSketch two = seen(walls, along(1, 47, 6), two_from_world);
  EXPECT_FALSE(judge_placings(one, two, {}));
  MergingOptions trusting;
  trusting.min_beyond = 0;
  trusting.beyond_share = 0;
  ASSERT_TRUE(judge_placings(one, two, trusting));
  EXPECT_GT(judge_placings(one, two, trusting)->log_odds, 7);
}

TEST(Merging, WallsThatWouldStandInTheOpenSpeakAgainstAPlacing) {
  const Walls walls = testing::store_of_crates();
  Walls other = walls;
  for (const double x : {17.0, 21.0, 25.0, 29.0}) testing::add_box(other, x, 3.5, x + 1.6, 5);
  const MapSketch one = seen(walls, along(1, 32, 6), one_from_world);
  const MapSketch two = seen(walls, along(16, 47, 6), two_from_world);
  const MapSketch with_more = seen(other, along(16, 47, 6), two_from_world);
  EXPECT_EQ(account_of(one, two, store_truth, {}).contradicted, 0);
  const PlacingAccount account = account_of(one, with_more, store_truth, {});
  EXPECT_GE(account.contradicted, 4);
  EXPECT_EQ(account.of_two.size(), with_more.walls.size());
  EXPECT_GE(std::count(account.of_two.begin(), account.of_two.end(), WallFate::contradicted), 4);
  const auto judged = judge_placings(one, with_more, {});
  EXPECT_TRUE(!judged || judged->log_odds < 7) << "too little is left";
}

TEST(Merging, WallsOfACorridorTellNothingAlongIt) {
  Walls walls;
  for (int i = 0; i < 12; ++i) {
    walls.push_back({{5.0 * i, -1}, {5.0 * i + 3 + 0.2 * i, -1}});
    walls.push_back({{5.0 * i, 1}, {5.0 * i + 4 - 0.2 * i, 1}});
  }
  EXPECT_FALSE(judge_placings(seen(walls, along(0, 40, 0), one_from_world),
                              seen(walls, along(20, 60, 0), two_from_world), {}));
}

TEST(Merging, ClutterByTheThousandIsBounded) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> anywhere(-40, 40), turn(0, 2 * std::numbers::pi), length(1, 4);
  const auto clutter = [&](int walls) {
    FeatureState state;
    add_robot(state, {}, Eigen::Matrix3d::Zero());
    for (int i = 0; i < walls; ++i) {
      const Eigen::Vector2d a(anywhere(random), anywhere(random));
      state.features.push_back(
          {i, segment_feature(a, a + rotate(turn(random), {length(random), 0}), true, true), 0, 0, 1, 0});
    }
    return sketch_of(state, {0}, {}, {});
  };
  const MergingOptions options;
  const MapSketch one = clutter(5'000), two = clutter(5'000);
  EXPECT_EQ(one.walls.size(), options.max_walls);
  EXPECT_LE(corners_of(one, options).size(), options.max_corners);
  EXPECT_LE(propose_placings(one, two, options).size(), options.max_placings);
  EXPECT_FALSE(judge_placings(one, two, options));
}

TEST(Merging, AViewTellsNothingWhereNothingCameBackOrWasTooNear) {
  Scan scan{0, 0, 0.1, {2, 80, 0.01F, 3}};
  const FreeView view = view_of(scan, {{}, 0.05, 80}, {}, 60);
  EXPECT_EQ(view.hit_m.size(), 60U);
  EXPECT_EQ(view.hit_m[0], 2);
  EXPECT_EQ(view.hit_m[2], 3) << "0.3 rad";
  EXPECT_EQ(std::count_if(view.hit_m.begin(), view.hit_m.end(), [](float hit) { return hit > 0; }), 2);
}

TEST(Merging, GroundIsFreeWhereTwoViewsSeeThrough) {
  const MergingOptions options;
  const Walls walls = testing::box(3);
  FreeGround ground(options);
  ground.add(look(walls, {0, 0}, options));
  EXPECT_FALSE(ground.is_free({1, 1})) << "one may have been somewhere else";
  ground.add(look(walls, {1, 0}, options));
  EXPECT_TRUE(ground.is_free({1, 1}));
  EXPECT_TRUE(ground.is_free({-1.5, -0.5}));
  EXPECT_FALSE(ground.is_free({2.9, 0})) << "near a wall";
  EXPECT_FALSE(ground.is_free({4, 0}));
  EXPECT_FALSE(ground.is_free({1e9, std::nan("")}));
}

}  // namespace
}  // namespace isthmus
