#include "tools/simulate/campaigns/sightings/closures.hpp"

#include <gtest/gtest.h>

#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

constexpr std::int64_t minute_us = 60'000'000;

// Four patches along a line, a minute and 5 m apart, one robot's or two robots'.
struct Line {
  MapCopy map;
  std::vector<RobotTruth> truth = {{"R1", {}}, {"R2", {}}};

  void add(const std::string& robot, const Pose& world_from_patch) {
    const PatchId id{static_cast<std::int32_t>(map.patches.size())};
    const std::int64_t utime = minute_us * (id.value + 1);
    map.patches.push_back(make_patch(id, robot, scan_from(furnished_room(), {}, utime), laser_of(), {}));
    map.poses.push_back(world_from_patch);
    map.graph.add_patch(id);
    truth[robot == "R1" ? 0 : 1].poses.push_back({utime, 0, world_from_patch});
  }

  void relate(int a, int b, const Pose& off, OriginKind origin = OriginKind::match,
              const Eigen::Vector3d& sigma = {0.05, 0.05, 0.02}) {
    Relation relation;
    relation.a = PatchId{a};
    relation.b = PatchId{b};
    relation.kind = RelationKind::relative_pose;
    const Pose truth_ab = ominus(world(b), world(a));
    relation.measurement = RelativePose{truth_ab * off, sigma.cwiseAbs2().cwiseInverse().asDiagonal()};
    relation.origin = {origin, {}};
    map.graph.add(relation);
  }

  Pose world(int patch) const {
    const std::int64_t utime = minute_us * (patch + 1);
    for (const RobotTruth& robot : truth)
      for (const TruePose& pose : robot.poses)
        if (pose.utime == utime) return pose.world_from_robot;
    return {};
  }
};

Line line_of_four(const std::string& second_robot) {
  Line line;
  line.add("R1", {0, 0, 0});
  line.add("R1", {5, 0, 0.1});
  line.add(second_robot, {10, 0, 0.2});
  line.add(second_robot, {15, 0, 0.3});
  return line;
}

TEST(JudgeClosures, TrueRelationsAreNotCounted) {
  Line line = line_of_four("R1");
  line.relate(0, 1, {0.3, 0.1, 0.1});
  line.relate(1, 2, {0, 0.9, 0});
  line.relate(2, 3, {3, 0, 0}, OriginKind::odometry);  // wheels may err
  const ClosureScore score = judge_closures(line.map, line.truth);
  EXPECT_EQ(score.relations, 2U);
  EXPECT_TRUE(score.wrong.empty());
  EXPECT_EQ(score.wrong_closures, 0U);
  EXPECT_EQ(score.islands, 1U);
}

TEST(JudgeClosures, WrongOnesAreFoundByWayAndByTurn) {
  Line line = line_of_four("R1");
  line.relate(0, 1, {});
  line.relate(1, 2, {});
  line.relate(2, 3, {});
  line.relate(0, 2, {1.5, 0, 0});
  line.relate(1, 3, {0, 0, 0.5}, OriginKind::hypothesis);
  line.relate(0, 3, {0, -2, 0}, OriginKind::propagation);
  line.relate(0, 3, {0, 2, 0}, OriginKind::sighting);  // judged elsewhere
  const ClosureScore score = judge_closures(line.map, line.truth);
  ASSERT_EQ(score.wrong.size(), 3U);
  EXPECT_NEAR(score.wrong[0].off_m, 1.5, 0.03);
  EXPECT_NEAR(score.wrong[1].off_rad, 0.5, 0.03);
  EXPECT_EQ(score.wrong[1].origin, OriginKind::hypothesis);
  EXPECT_EQ(score.wrong_closures, 3U);
}

TEST(JudgeClosures, OneThatLeavesRoomForTheTruthIsNotWrong) {
  Line line = line_of_four("R1");
  line.relate(0, 1, {1.5, 0, 0}, OriginKind::match, {10, 0.05, 0.02});
  EXPECT_TRUE(judge_closures(line.map, line.truth).wrong.empty());
}

// Firmly a hand's breadth off one way, and far off the other way, where it says next to nothing.
TEST(JudgeClosures, OneThatIsFarOffOnlyWhereItSaysLittleIsNotWrong) {
  Line line = line_of_four("R1");
  line.relate(0, 1, {1.5, 0.2, 0}, OriginKind::match, {2, 0.02, 0.02});
  EXPECT_TRUE(judge_closures(line.map, line.truth).wrong.empty());
}

TEST(JudgeClosures, SeveralRelationsOfTheSamePlacesAreOneClosure) {
  Line line = line_of_four("R1");
  line.relate(0, 3, {2, 0, 0});
  line.relate(3, 0, {2, 0, 0});
  const ClosureScore score = judge_closures(line.map, line.truth);
  EXPECT_EQ(score.wrong.size(), 2U);
  EXPECT_EQ(score.wrong_closures, 1U);
}

TEST(JudgeClosures, RobotsOnOneIslandWhereTheyAreNotAreAWrongMerge) {
  Line line = line_of_four("R2");
  line.relate(0, 1, {});
  line.relate(2, 3, {});
  EXPECT_EQ(judge_closures(line.map, line.truth).islands, 2U);
  line.relate(1, 2, {});
  EXPECT_EQ(judge_closures(line.map, line.truth).wrong_merges, 0U);
  for (const std::size_t i : {2U, 3U}) line.map.poses[i] = Pose{4, 0, 0} * line.map.poses[i];
  EXPECT_EQ(judge_closures(line.map, line.truth).wrong_merges, 1U);
}

}  // namespace
}  // namespace isthmus
