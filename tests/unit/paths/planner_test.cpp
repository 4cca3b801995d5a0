#include "server/paths/questions/planner.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/ground_scenes.hpp"

namespace isthmus {
namespace {

using testing::slim;
using testing::Spiral;

Path ask(const Map& map, const ManifoldPose& from, const ManifoldPose& to,
         const Footprint& footprint = slim) {
  Planner planner;
  planner.update(testing::shared_copy(map));
  return planner.path({from, to, footprint});
}

Map room_map() {
  Map map;
  testing::add_round_way(map, testing::furnished_room(), {{-1, 0, 0}, {1, 0, 0}});
  return map;
}

TEST(Planner, BeforeALoopIsClosedAPathGoesRoundAndDoesNotChangeLayers) {
  const Spiral spiral;
  const Path path = ask(spiral.map, {PatchId{10}, {}}, {PatchId{10 + Spiral::lap_patches}, {}});
  ASSERT_EQ(path.refusal, Refusal::none);
  EXPECT_GT(path.length_m, 0.9 * Spiral::lap_patches);
  for (std::size_t i = 1; i < path.poses.size(); ++i)
    EXPECT_LE(std::abs(path.poses[i].patch.value - path.poses[i - 1].patch.value), 3);
}

TEST(Planner, OnceItIsClosedTheTwoAreOnePlace) {
  Spiral spiral;
  spiral.close(10);
  const Path path = ask(spiral.map, {PatchId{10}, {}}, {PatchId{10 + Spiral::lap_patches}, {}});
  ASSERT_EQ(path.refusal, Refusal::none);
  EXPECT_LT(path.length_m, 0.2);
}

TEST(Planner, APathGoesRoundAPillarAtTheDistanceAsked) {
  Map map;
  testing::Walls walls;
  testing::add_box(walls, -4, -3, 4, 3);
  testing::add_box(walls, -0.2, -0.2, 0.2, 0.2);
  testing::add_round_way(map, walls, {{-2, 0, 0}, {0, 1.5, 0}, {2, 0, 0}});
  Planner planner;
  planner.update(testing::shared_copy(map));
  const Path path = planner.path({{PatchId{0}, {}}, {PatchId{2}, {}}, slim});
  ASSERT_EQ(path.refusal, Refusal::none);
  double nearest = 10;
  for (std::size_t i = 1; i < path.poses.size(); ++i) {
    const Eigen::Vector2d a = position(planner.project(path.poses[i - 1])),
                          b = position(planner.project(path.poses[i]));
    for (int part = 0; part <= 20; ++part) {
      const Eigen::Vector2d point = a + (b - a) * (part / 20.0);
      nearest = std::min(nearest, (point.cwiseAbs() - Eigen::Vector2d(0.2, 0.2)).cwiseMax(0).norm());
    }
  }
  EXPECT_GE(nearest, 0.3 - 0.01);  // the pillar's hits lie within a centimetre of it
  EXPECT_LT(path.length_m, 4.4);
}

TEST(Planner, APathFacesTheWayItGoesAndIsAMetreApart) {
  const Map map = room_map();
  Planner planner;
  planner.update(testing::shared_copy(map));
  const Path path = planner.path({{PatchId{0}, {-1.5, -1, 2}}, {PatchId{1}, {1.5, -1, 0}}, slim});
  ASSERT_EQ(path.refusal, Refusal::none);
  EXPECT_EQ(path.poses.front().patch_from_object, (Pose{-1.5, -1, 2}));
  for (std::size_t i = 1; i < path.poses.size(); ++i) {
    const Pose before = planner.project(path.poses[i - 1]), after = planner.project(path.poses[i]);
    EXPECT_LE((position(after) - position(before)).norm(), 1.01);
  }
  EXPECT_NEAR(planner.project(path.poses.back()).yaw, 0, 0.1);
}

TEST(Planner, APathMovesWithItsPatchesWhenTheMapIsRefitted) {
  Map map = room_map();
  Planner planner;
  planner.update(testing::shared_copy(map));
  const PathQuestion question{{PatchId{0}, {}}, {PatchId{1}, {}}, slim};
  const Path before = planner.path(question);
  map.move_island(IslandId{0}, {5, 3, 0.7});
  planner.update(testing::shared_copy(map));
  const Path after = planner.path(question);
  ASSERT_EQ(after.refusal, Refusal::none);
  EXPECT_NEAR(after.length_m, before.length_m, 0.1);
  EXPECT_NEAR(
      (position(planner.project(before.poses.back())) - position(planner.project(after.poses.back()))).norm(),
      0, 0.15);
}

TEST(Planner, ARobotThatStandsTooNearToAWallLeavesItFirst) {
  const Path path = ask(room_map(), {PatchId{0}, {0, -2.85, 0}}, {PatchId{1}, {}});
  ASSERT_EQ(path.refusal, Refusal::none);
  EXPECT_LT(path.poses[1].patch_from_object.y, -2.5);
  EXPECT_GT(path.poses[1].patch_from_object.y, -2.75);
}

TEST(Planner, QuestionsWithoutAnAnswerAreRefusedWithTheReason) {
  const Map map = room_map();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const ManifoldPose here{PatchId{0}, {}};
  EXPECT_EQ(ask(map, here, {PatchId{7}, {}}).refusal, Refusal::unknown_patch);
  EXPECT_EQ(ask(map, {PatchId{}, {}}, here).refusal, Refusal::unknown_patch);
  EXPECT_EQ(ask(map, here, {PatchId{0}, {nan, 0, 0}}).refusal, Refusal::bad_value);
  EXPECT_EQ(ask(map, here, {PatchId{0}, {1e9, 0, 0}}).refusal, Refusal::bad_value);
  EXPECT_EQ(ask(map, here, here, {nan, 0.1}).refusal, Refusal::bad_value);
  EXPECT_EQ(ask(map, here, here, {-1, 0.1}).refusal, Refusal::bad_value);
  EXPECT_EQ(ask(map, here, here, {0.7, 0.7}).refusal, Refusal::bad_value);
  EXPECT_EQ(ask(map, here, {PatchId{0}, {0, -9, 0}}).refusal, Refusal::no_room);
}

TEST(Planner, TwoIslandsAndTwoRoomsHaveNoPathBetweenThem) {
  Map map = room_map();
  map.add(testing::round_patch(testing::furnished_room(), PatchId{2}, {}), {});
  EXPECT_EQ(ask(map, {PatchId{0}, {}}, {PatchId{2}, {}}).refusal, Refusal::other_island);
  testing::Walls other;
  testing::add_box(other, 5, -3, 9, 3);
  Map rooms = room_map();
  rooms.add(testing::round_patch(other, PatchId{2}, {7, 0, 0}), {7, 0, 0});
  rooms.relate(testing::odometry_relation(PatchId{1}, PatchId{2}, {6, 0, 0}));
  EXPECT_EQ(ask(rooms, {PatchId{0}, {}}, {PatchId{2}, {}}).refusal, Refusal::unreachable);
}

TEST(Planner, PatchesThatOperatorsLeftOutAreNoGround) {
  MapCopy copy = testing::copy_of(room_map());
  copy.left_out = {PatchId{0}, PatchId{1}};
  Planner planner;
  planner.update(std::make_shared<const MapCopy>(copy));
  EXPECT_EQ(planner.path({{PatchId{0}, {}}, {PatchId{1}, {}}, slim}).refusal, Refusal::unknown_patch);
  EXPECT_EQ(planner.roadmap(IslandId{0}, slim), nullptr);
}

TEST(Planner, RoadmapsAreKeptWhileTheGroundStaysAndOfEightFootprintsAtMost) {
  Map map = room_map();
  Planner planner;
  planner.update(testing::shared_copy(map));
  const auto first = planner.roadmap(IslandId{0}, slim);
  planner.update(testing::shared_copy(map));
  EXPECT_EQ(planner.roadmap(IslandId{0}, slim), first);
  for (int i = 0; i < 8; ++i) planner.roadmap(IslandId{0}, {0.1 + 0.01 * i, 0.1});
  EXPECT_NE(planner.roadmap(IslandId{0}, slim), first);
}

TEST(Refusal, WordsStay) {
  EXPECT_EQ(word(Refusal::none), "none");
  EXPECT_EQ(word(Refusal::other_island), "other_island");
  EXPECT_EQ(word(Refusal::too_long), "too_long");
}

}  // namespace
}  // namespace isthmus
