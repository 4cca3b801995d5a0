#include "server/engine/closures/withdrawal.hpp"

#include <gtest/gtest.h>

#include <memory>

#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using testing::odometry_relation;

// Two robots' patches a metre apart, joined by a closure: a sighting, and what it made possible to match.
//
//     R1: 0 --- 1 --- 2
//               |     |
//     R2: 3 --- 4 --- 5
//
// R2 has driven on over R1's patches, 0.3 m from its newest own one; R1 stands on its own.
struct Joined {
  Joined() {
    for (int i = 0; i < 6; ++i) {
      auto patch = std::make_shared<Patch>();
      patch->id = PatchId{i};
      patch->robot = i < 3 ? "R1" : "R2";
      map.add(patch, {1.0 * (i % 3), i < 3 ? 0.0 : -1.0, 0});
      if (i % 3 > 0) map.relate(odometry_relation(PatchId{i - 1}, PatchId{i}, {1, 0, 0}));
    }
    sighting = relate(1, 4, OriginKind::sighting);
    induced = relate(2, 5, OriginKind::propagation);
    put("R1", 2, {0.1, 0, 0}, 2);
    put("R2", 2, {0.3, -1, 0}, 5);
    robots["R2"].place->since_last_patch.append({0.3, 0, 0.2}, 0.01 * Eigen::Matrix3d::Identity());
  }
  RelationId relate(int a, int b, OriginKind kind) {
    Relation relation = odometry_relation(PatchId{a}, PatchId{b}, {0, -1, 0});
    relation.kind = kind == OriginKind::sighting ? RelationKind::relative_pose : RelationKind::point_to_line;
    relation.origin = {kind, ClosureId{7}};
    return map.relate(relation);
  }
  void put(const std::string& name, int patch, const Pose& patch_from_robot, int last_patch) {
    robots[name].place = Localisation{};
    robots[name].place->pose = {PatchId{patch}, patch_from_robot};
    robots[name].place->last_patch = PatchId{last_patch};
  }
  PatchId stands_on(const std::string& name) const { return robots.at(name).place->pose.patch; }

  Map map;
  std::map<std::string, Robot> robots;
  RelationId sighting;
  RelationId induced;
};

std::vector<RelationId> ids(const std::vector<Relation>& relations) {
  std::vector<RelationId> all;
  for (const Relation& relation : relations) all.push_back(relation.id);
  return all;
}

TEST(Withdraw, TakesTheClosureAndWhatItMadePossibleOutOfTheMap) {
  Joined joined;
  const Withdrawal withdrawal = withdraw(joined.map, ClosureId{7}, joined.robots, {});
  EXPECT_EQ(ids(withdrawal.gone), (std::vector<RelationId>{joined.sighting, joined.induced}));
  EXPECT_TRUE(withdrawal.fallen.empty());
  EXPECT_EQ(joined.map.graph().islands().size(), 2U) << "nothing else joins them";
  EXPECT_EQ(joined.map.graph().relations().size(), 4U) << "each robot's odometry stays";
}

// As surely as its odometry since its own newest patch says.
TEST(Withdraw, PutsARobotBackOnItsOwnSide) {
  Joined joined;
  withdraw(joined.map, ClosureId{7}, joined.robots, {});
  EXPECT_EQ(joined.stands_on("R2"), PatchId{5});
  const Localisation& place = *joined.robots["R2"].place;
  EXPECT_NEAR(place.pose.patch_from_object.x, 0.3, 1e-9);
  EXPECT_NEAR(place.pose.patch_from_object.yaw, 0.2, 1e-9);
  EXPECT_EQ(place.covariance, place.since_last_patch.covariance);
  EXPECT_EQ(joined.stands_on("R1"), PatchId{2}) << "it was on its own";
  EXPECT_NEAR(joined.robots["R1"].place->pose.patch_from_object.x, 0.1, 1e-9);
}

TEST(Withdraw, OfAClosureThatIsNotOnTheMapChangesNothing) {
  Joined joined;
  EXPECT_TRUE(withdraw(joined.map, ClosureId{8}, joined.robots, {}).gone.empty());
  EXPECT_EQ(joined.map.graph().islands().size(), 1U);
  EXPECT_EQ(joined.stands_on("R2"), PatchId{2});
}

TEST(TakeOut, LeavesEachPatchOfTheRobotAlone) {
  Joined joined;
  joined.put("R1", 5, {0.2, 0, 0}, 2);
  const std::vector<Relation> taken = take_out(joined.map, "R2", joined.robots);
  EXPECT_EQ(taken.size(), 4U) << "its odometry, and what joined it to R1";
  EXPECT_EQ(joined.map.graph().relations().size(), 2U);
  EXPECT_EQ(joined.map.graph().islands().size(), 4U);
  EXPECT_EQ(joined.stands_on("R1"), PatchId{2}) << "what it stood on is no longer with its own";
}

}  // namespace
}  // namespace isthmus
