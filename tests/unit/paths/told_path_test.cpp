#include "server/paths/questions/told_path.hpp"

#include <gtest/gtest.h>

#include "tests/support/ground_scenes.hpp"

namespace isthmus {
namespace {

using testing::slim;
using testing::Spiral;

/// A room of 8 by 6 m, with a wall across it that leaves `door_m` open at its upper end.
testing::Walls divided_room(double door_m) {
  testing::Walls walls;
  testing::add_box(walls, -4, -3, 4, 3);
  if (door_m < 6) testing::add_box(walls, -0.1, -3, 0.1, 3 - door_m);
  return walls;
}

/// Seen from both ends and from the middle of the upper wall, as the map has it: `map_shift_m` further right
/// than the first patch says.
std::shared_ptr<const MapCopy> room(double door_m, double map_shift_m = 0) {
  Map map;
  const testing::Walls walls = divided_room(door_m);
  const std::vector<Pose> poses{{-3, -2, 0}, {3, -2, 0}, {0, 2.6, 0}};
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const PatchId id{static_cast<std::int32_t>(i)};
    Pose at = poses[i];
    if (i > 0) at.x += map_shift_m;
    map.add(testing::round_patch(walls, id, poses[i]), at);
    if (i > 0) map.relate(testing::odometry_relation(PatchId{0}, id, map.relative_pose(PatchId{0}, id)));
  }
  return testing::shared_copy(map);
}

class ToldPathTest : public ::testing::Test {
 protected:
  void tell(std::shared_ptr<const MapCopy> map) {
    planner_.update(std::move(map));
    told_ = {};
    for (const ManifoldPose& pose : planner_.path({from_, to_, slim}).poses) {
      told_.poses.push_back(pose);
      told_.map_points.push_back(position(planner_.project(pose)));
    }
  }
  PathChange look(std::shared_ptr<const MapCopy> map) {
    planner_ = {};  // what patches show is theirs for ever: these are others
    planner_.update(std::move(map));
    PathNow now{robot_.value_or(from_), slim, true, true, {}};
    now.path = planner_.path({now.robot, to_, slim});
    return change_of(planner_, told_, now);
  }

  Planner planner_;
  ManifoldPose from_{PatchId{0}, {}}, to_{PatchId{1}, {}};
  std::optional<ManifoldPose> robot_;  // that has driven on
  ToldPath told_;
};

TEST_F(ToldPathTest, HoldsAsLongAsTheMapAndWhileTheRobotDrivesIt) {
  tell(room(2));
  ASSERT_GT(told_.poses.size(), 3U);
  EXPECT_EQ(look(room(2)), PathChange::none);
  robot_ = told_.poses[told_.poses.size() / 2];
  EXPECT_EQ(look(room(2)), PathChange::none);
  EXPECT_EQ(look(room(2, 0.02)), PathChange::none) << "less than a cell";
}

TEST_F(ToldPathTest, IsMovedByTheMap) {
  tell(room(2));
  EXPECT_EQ(look(room(2, 0.08)), PathChange::moved);
}

TEST_F(ToldPathTest, WhatIsBehindTheRobotDoesNotMoveIt) {
  tell(room(2));
  robot_ = told_.poses.back();
  robot_->patch_from_object.x -= 0.8;
  told_.map_points.front().x() += 1;
  EXPECT_EQ(look(room(2)), PathChange::none);
}

TEST_F(ToldPathTest, IsBlockedByAWallThatWasNotThere) {
  tell(room(6));
  EXPECT_EQ(look(room(2)), PathChange::blocked) << "there is a way round";
  EXPECT_EQ(look(room(0)), PathChange::blocked) << "there is none";
}

TEST_F(ToldPathTest, OpensWhereThereWasNone) {
  tell(room(0));
  ASSERT_TRUE(told_.poses.empty());
  EXPECT_EQ(look(room(0)), PathChange::none);
  EXPECT_EQ(look(room(2)), PathChange::opened);
}

TEST_F(ToldPathTest, IsShortenedWhereAWallIsGone) {
  tell(room(2));
  EXPECT_EQ(look(room(6)), PathChange::shortened);
}

TEST_F(ToldPathTest, FollowsATargetThatMovesAndEndsThere) {
  tell(room(6));
  to_.patch_from_object.y += 0.4;
  EXPECT_EQ(look(room(6)), PathChange::none) << "a path may end so far from its target";
  to_.patch_from_object.y += 0.4;
  EXPECT_EQ(look(room(6)), PathChange::target_moved);
  robot_ = told_.poses.back();
  EXPECT_EQ(look(room(6)), PathChange::arrived);
}

TEST_F(ToldPathTest, APatchThatWasLeftOutBlocksIt) {
  tell(room(2));
  MapCopy copy = *room(2);
  copy.left_out = {told_.poses[told_.poses.size() / 2].patch};
  EXPECT_EQ(look(std::make_shared<const MapCopy>(copy)), PathChange::blocked);
}

TEST(ToldPath, WhereItLiesOverItselfTheOtherLapIsNotWhatIsLeft) {
  const Spiral spiral;
  const ManifoldPose to{PatchId{20 + Spiral::lap_patches}, {}};
  Planner planner;
  planner.update(testing::shared_copy(spiral.map));
  ToldPath told;
  for (const ManifoldPose& pose : planner.path({{PatchId{10}, {}}, to, slim}).poses) {
    told.poses.push_back(pose);
    told.map_points.push_back(position(planner.project(pose)));
  }
  ASSERT_FALSE(told.poses.empty());
  PathNow now{{PatchId{15 + Spiral::lap_patches}, {}}, slim, true, true, {}};
  now.path = planner.path({now.robot, to, slim});
  ASSERT_LT(now.path.length_m, 10);
  EXPECT_EQ(change_of(planner, told, now), PathChange::none);
}

}  // namespace
}  // namespace isthmus
