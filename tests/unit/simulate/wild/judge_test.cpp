#include "tools/simulate/wild/judge.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <numbers>

#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

constexpr std::int64_t second_us = 1'000'000;

std::int64_t turns_back(int length_m) { return (40 + length_m) * second_us; }

// One robot drives along x at 1 m/s, waits for 40 s, comes back a metre aside, and then stands.
std::vector<RobotTruth> there_and_back(const std::string& robot = "R1", int length_m = 20) {
  std::vector<RobotTruth> truth{{robot, {}}};
  const auto add = [&](int second, const Pose& pose) {
    truth[0].poses.push_back({second * second_us, 0, pose});
  };
  for (int i = 0; i <= length_m; ++i) add(i, {static_cast<double>(i), 0, 0});
  for (int i = 0; i <= length_m; ++i)
    add(40 + length_m + i, {static_cast<double>(length_m - i), 1, std::numbers::pi});
  for (int i = 1; i <= 20; ++i) add(40 + 2 * length_m + i, {0, 1, std::numbers::pi});
  return truth;
}

Scenario empty_floor(double wall_y = 50) {
  Scenario scenario;
  Building building;
  building.walls.push_back({{{-50, wall_y}, {50, wall_y}}, false, {}});
  scenario.plan = build_floor_plan(building);
  return scenario;
}

std::size_t came_back(const std::vector<ScanRelation>& relations) {
  return static_cast<std::size_t>(std::ranges::count_if(
      relations, [](const ScanRelation& r) { return std::abs(r.utime2 - r.utime1) >= 30 * second_us; }));
}

TEST(WildRelations, TellOfNeighboursAlongTheWayAndOfWhereARobotHasBeen) {
  const auto relations = wild_relations(empty_floor(), there_and_back());
  EXPECT_EQ(came_back(relations), 22U);  // each of the 21 on the way back, and the step aside between
  EXPECT_EQ(relations.size(), 41U + 21U);
  for (const ScanRelation& r : relations) EXPECT_LE(std::hypot(r.pose.x, r.pose.y), 3);
}

TEST(WildRelations, NoneGoesThroughAWall) {
  EXPECT_EQ(came_back(wild_relations(empty_floor(0.5), there_and_back())), 1U);
}

TEST(WildRelations, TwoRobotsThatWereAtOnePlaceAreComparedWhenever) {
  auto truth = there_and_back("R1");
  const auto second = there_and_back("R2");
  truth.push_back(second[0]);
  std::size_t between = 0;
  for (const ScanRelation& r : wild_relations(empty_floor(), truth))
    between += r.robot1 != r.robot2 ? 1U : 0U;
  EXPECT_EQ(between, 42U);
}

// A map that holds a true drive but for the way back, which is `off_m` aside and may be an island of its own.
MapCopy map_of(const std::vector<RobotTruth>& truth, double off_m, bool parted, int length_m) {
  MapCopy map;
  auto rows = std::make_shared<TrajectoryStore>();
  for (const int part : {0, 1}) {
    const PatchId patch{part};
    const TruePose& first = part == 0
                                ? truth[0].poses.front()
                                : *std::ranges::find(truth[0].poses, turns_back(length_m), &TruePose::utime);
    map.graph.add_patch(patch);
    map.poses.push_back(Pose{0, part * off_m, 0} * first.world_from_robot);
    map.patches.push_back(
        make_patch(patch, "R1", scan_from(furnished_room(), {}, first.utime), laser_of(), {}));
    if (part == 0 || parted) map.sessions.push_back({"R1", part, 0, 0, patch});
    for (const TruePose& pose : truth[0].poses) {
      if ((pose.utime >= turns_back(length_m)) != (part == 1)) continue;
      const Pose patch_from_robot = ominus(pose.world_from_robot, first.world_from_robot);
      rows->append({pose.utime, parted ? part : 0, patch, patch_from_robot});
    }
  }
  if (!parted) {
    Relation relation;
    relation.a = PatchId{0};
    relation.b = PatchId{1};
    relation.measurement = RelativePose{ominus(map.poses[1], map.poses[0]), Eigen::Matrix3d::Identity()};
    map.graph.add(relation);
  }
  rows->flush();
  map.trajectory = rows;
  map.trajectory_rows = rows->size();
  return map;
}

WildScore judged(double off_m, bool parted, int length_m = 20) {
  SimulatedRun run;
  run.truth = there_and_back("R1", length_m);
  return judge_wild(empty_floor(), run, map_of(run.truth, off_m, parted, length_m));
}

TEST(WildJudge, ATrueMapIsWithoutFault) {
  const WildScore score = judged(0, false);
  EXPECT_EQ(score.islands, 1U);
  EXPECT_EQ(score.relations, 62U);
  EXPECT_LT(score.max_m, 1e-6);
  EXPECT_FALSE(score.failed());
}

TEST(WildJudge, ARelationThatIsMoreThanAMetreOffIsAFailure) {
  EXPECT_FALSE(judged(0.9, false).failed());
  const WildScore score = judged(1.1, false);
  EXPECT_TRUE(score.is_off());
  EXPECT_NEAR(score.max_m, 1.1, 1e-6);
  EXPECT_GT(score.mean_m, 0.3);
  EXPECT_LT(score.mean_m, 0.5);
}

TEST(WildJudge, TwoIslandsThatShareALongWayAreAMergeThatWasMissed) {
  const WildScore score = judged(1.1, true, 40);
  EXPECT_EQ(score.islands, 2U);
  EXPECT_FALSE(score.is_off());
  EXPECT_EQ(score.missing, 42U);
  EXPECT_EQ(score.missed_merges, 1U);
  EXPECT_TRUE(score.failed());
}

TEST(WildJudge, TwoIslandsThatShareLittleMayStayApart) {
  EXPECT_EQ(judged(0, true).islands, 2U);
  EXPECT_FALSE(judged(0, true).failed());
}

}  // namespace
}  // namespace isthmus
