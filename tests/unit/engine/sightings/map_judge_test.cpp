#include "server/engine/sightings/map_judge.hpp"

#include <gtest/gtest.h>

#include "tests/support/side_by_side.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

const Eigen::Vector3d unsure{1, 1, 10};  // a metre, a third of a radian

SideBySide joined(const Eigen::Vector3d& information, const Walls& walls = furnished_room()) {
  SideBySide scene(walls);
  scene.join(information);
  return scene;
}

Judgement judged(MapJudge& judge, const SideBySide& scene, const SightingEvent& sighting) {
  return judge.judge(scene.map, scene.evidence(sighting, 0), scene.options);
}

Judgement judged(const SideBySide& scene, const SightingEvent& sighting) {
  MapJudge judge;
  return judged(judge, scene, sighting);
}

SightingEvent a_metre_off(double s) {
  return SideBySide::seen("R1", s, 2, SideBySide::r2_at(s) + Eigen::Vector2d(1, 0));
}

TEST(MapJudge, CannotTellBetweenTwoIslands) {
  EXPECT_EQ(judged(SideBySide(), SideBySide::r1_sees_r2(14)), Judgement::unknown);
}

TEST(MapJudge, WhereItKnowsWellAgreesOrContradicts) {
  const SideBySide scene = joined({1e4, 1e4, 1e5});
  EXPECT_EQ(judged(scene, SideBySide::r1_sees_r2(14)), Judgement::agrees);
  EXPECT_EQ(judged(scene, SideBySide::r2_sees_r1(14)), Judgement::agrees);
  EXPECT_EQ(judged(scene, a_metre_off(14)), Judgement::contradicts);
}

TEST(MapJudge, CannotTellWhereItDoesNotKnowWell) {
  const SideBySide scene = joined(unsure);
  EXPECT_EQ(judged(scene, SideBySide::r1_sees_r2(14)), Judgement::unknown);
  EXPECT_EQ(judged(scene, a_metre_off(14)), Judgement::unknown);
}

TEST(MapJudge, BelievesTheScansBetweenPatchesThatAreNearInTheGraph) {
  EXPECT_EQ(judged(joined(unsure), SideBySide::r1_sees_r2(10)), Judgement::agrees);
}

// Sightings close in time err alike.
TEST(MapJudge, WeighsOnlyOneOfThoseThatAreCloseInTime) {
  MapJudge judge;
  EXPECT_EQ(judged(judge, joined({1e4, 1e4, 1e5}), SideBySide::r1_sees_r2(13)), Judgement::agrees);
  const SideBySide scene = joined(unsure);
  EXPECT_EQ(judged(judge, scene, SideBySide::r1_sees_r2(14)), Judgement::agrees);
  EXPECT_EQ(judged(judge, scene, SideBySide::r1_sees_r2(15)), Judgement::unknown) << "two seconds later";
  EXPECT_EQ(judged(judge, scene, SideBySide::r2_sees_r1(14)), Judgement::unknown) << "of other robots";
}

TEST(MapJudge, LearnsFromASightingWhereThereAreNoScans) {
  EXPECT_EQ(judged(joined({25, 25, 1e3}, Walls{}), SideBySide::r1_sees_r2(11)), Judgement::teaches);
  EXPECT_EQ(judged(joined({1e4, 1e4, 1e6}, Walls{}), SideBySide::r1_sees_r2(11)), Judgement::agrees)
      << "it says less than is known";
}

}  // namespace
}  // namespace isthmus
