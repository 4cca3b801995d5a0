#include "server/engine/rendezvous/meeting_plan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/engine/hypotheses/undecided.hpp"
#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

using std::numbers::pi;

Robot wearing(std::int32_t barcode) {
  Robot robot;
  robot.declaration.barcode = barcode;
  robot.declared = true;
  return robot;
}

TEST(MeetingPlan, IsOfRobotsThatWearBarcodes) {
  EXPECT_TRUE(could_see_one_another(wearing(0), wearing(7)));
  EXPECT_FALSE(could_see_one_another(wearing(-1), wearing(7)));
  EXPECT_FALSE(could_see_one_another(wearing(7), wearing(-1)));
}

// A robot in each of two rooms; in truth, were the hypothesis true, one room: the first patch at its middle,
// the second 2 m ahead of it, looking back.
struct TwoRooms {
  explicit TwoRooms(const Walls& of_second = furnished_room()) {
    add_way(map, furnished_room(), {{0, 0, 0}});
    add_way(map, {of_second}, {{2, 0, pi}}, second_from_world);
    for (const auto& [name, patch] : {std::pair{"R1", 0}, {"R2", 1}}) {
      robots[name] = wearing(patch);
      robots[name].declaration.robot = name;
      robots[name].place = Localisation{};
      robots[name].place->pose = {PatchId{patch}, {}};
    }
  }
  std::optional<MeetingPlan> plan() const { return plan_meeting(map, robots, hypothesis, {}); }

  const Pose second_from_world{50, 20, 1};
  const UndecidedHypothesis hypothesis{ClosureId{3}, PatchId{0}, PatchId{1}, {2, 0, pi}, 1};
  Map map;
  std::map<std::string, Robot> robots;
};

TEST(MeetingPlan, LaysTheSecondIslandWhereTheHypothesisHasIt) {
  const TwoRooms rooms;
  const Pose back = first_map_from_second_map(rooms.map, rooms.hypothesis) * rooms.second_from_world;
  EXPECT_NEAR(back.x, 0, 1e-9);
  EXPECT_NEAR(back.y, 0, 1e-9);
  EXPECT_NEAR(back.yaw, 0, 1e-9);
}

// Each on its own robot's island, face to face and near, were the hypothesis true.
TEST(MeetingPlan, PutsTwoRobotsFaceToFace) {
  const TwoRooms rooms;
  const std::optional<MeetingPlan> plan = rooms.plan();
  ASSERT_TRUE(plan);
  EXPECT_EQ(plan->hypothesis.id, ClosureId{3});
  EXPECT_EQ(plan->a.robot, "R1");
  EXPECT_EQ(plan->b.robot, "R2");
  EXPECT_EQ(plan->a.pose.patch, PatchId{0});
  EXPECT_EQ(plan->b.pose.patch, PatchId{1});
  const Pose a = rooms.map.manifold().project(plan->a.pose);
  const Pose b =
      first_map_from_second_map(rooms.map, rooms.hypothesis) * rooms.map.manifold().project(plan->b.pose);
  const Pose seen = ominus(b, a);
  EXPECT_GE(std::hypot(seen.x, seen.y), 1.5 - 1e-9);
  EXPECT_LE(std::hypot(seen.x, seen.y), 2 + 1e-9);
  EXPECT_NEAR(std::atan2(seen.y, seen.x), 0, 1e-9);
  EXPECT_NEAR(std::abs(seen.yaw), pi, 1e-9);
}

// The second island knows no room wide enough for a robot between the two.
TEST(MeetingPlan, NeedsRoomToStandAndToSee) {
  Walls narrow;
  add_box(narrow, 1.7, -0.3, 2.3, 0.3);
  EXPECT_FALSE(TwoRooms(narrow).plan());
}

TEST(MeetingPlan, IsBetweenIslandsWithARobotEach) {
  TwoRooms gone;
  gone.robots["R2"].place.reset();
  EXPECT_FALSE(gone.plan());
  TwoRooms joined;
  joined.map.relate(odometry_relation(PatchId{0}, PatchId{1}, {2, 0, pi}));
  EXPECT_FALSE(joined.plan()) << "it is decided";
}

}  // namespace
}  // namespace isthmus
