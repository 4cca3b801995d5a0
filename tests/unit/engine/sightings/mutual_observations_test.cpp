#include "server/engine/sightings/mutual_observations.hpp"

#include <gtest/gtest.h>

#include "tests/support/side_by_side.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

/// R1 has seen R2 at each second from 10 on.
MutualObservations observations_of(SideBySide& scene, int count, double now_s = 16) {
  MutualObservations observations;
  for (int i = 0; i < count; ++i)
    observations.take(SideBySide::r1_sees_r2(10 + i), "R2", false, SideBySide::utime(10 + i));
  observations.place(scene.world(now_s), {});
  return observations;
}

void expect(const MutualObservations& observations, std::size_t record, Verdict verdict, Reason reason) {
  const SightingRecord its = observations.log()[record];
  EXPECT_EQ(word(its.verdict), word(verdict)) << record;
  EXPECT_EQ(word(its.reason), word(reason)) << record;
}

TEST(MutualObservations, WaitUntilTheyArePlaced) {
  MutualObservations observations;
  observations.take(SideBySide::r1_sees_r2(12), "R2", false, SideBySide::utime(12));
  expect(observations, 0, Verdict::waiting, Reason::not_placed_yet);
  EXPECT_TRUE(observations.has_work());
  observations.refuse(SideBySide::r1_sees_r2(13), Reason::sees_itself);
  expect(observations, 1, Verdict::refused, Reason::sees_itself);
}

TEST(MutualObservations, BetweenTwoIslandsAreInThePool) {
  SideBySide scene;
  MutualObservations observations = observations_of(scene, 2);
  EXPECT_EQ(observations.pool().size(), 2U);
  EXPECT_TRUE(observations.take_changed());
  EXPECT_FALSE(observations.take_changed());
  expect(observations, 0, Verdict::waiting, Reason::unsupported);
  EXPECT_FALSE(observations.has_work());
}

TEST(MutualObservations, ThatTheMapKnowsWellAreAcceptedAtOnce) {
  SideBySide scene;
  scene.join();
  const MutualObservations observations = observations_of(scene, 3);
  EXPECT_TRUE(observations.pool().empty());
  for (const std::size_t i : {0U, 1U, 2U})
    expect(observations, i, Verdict::accepted, Reason::agrees_with_map);
}

TEST(MutualObservations, ThatContradictTheMapWaitForOthersThatDo) {
  SideBySide scene;
  scene.join();
  MutualObservations observations;
  observations.take(SideBySide::seen("R1", 14, 2, {3, 2}), "R2", false, 0);
  observations.place(scene.world(16), {});
  EXPECT_EQ(observations.pool().size(), 1U);
  expect(observations, 0, Verdict::waiting, Reason::contradicts_map);
}

TEST(MutualObservations, OfTheFutureWaitTwoSecondsForIt) {
  SideBySide scene;
  MutualObservations observations;
  observations.take(SideBySide::r1_sees_r2(40), "R2", false, SideBySide::utime(15));
  observations.place(scene.world(17), {});
  expect(observations, 0, Verdict::waiting, Reason::not_placed_yet);
  observations.place(scene.world(17.1), {});
  expect(observations, 0, Verdict::refused, Reason::stamp_in_future);
}

TEST(MutualObservations, AreJudgedAgainAFewAtATimeWhenTheMapHasChanged) {
  SideBySide scene;
  MutualObservations observations = observations_of(scene, 6);
  scene.join();
  observations.consider_again({});
  observations.judge_again(scene.world(16));
  EXPECT_EQ(observations.log().count(Verdict::accepted), 4);
  EXPECT_EQ(observations.pool().size(), 2U);
  EXPECT_TRUE(observations.is_judging_again());
  observations.judge_again(scene.world(16));
  EXPECT_EQ(observations.log().count(Verdict::accepted), 6);
  EXPECT_FALSE(observations.is_judging_again());
}

TEST(MutualObservations, ThatAreTakenOutAndPutBackAreInTheirOldOrder) {
  SideBySide scene;
  MutualObservations observations = observations_of(scene, 4);
  std::vector<Evidence> taken = observations.take_out({0, 2});
  ASSERT_EQ(taken.size(), 2U);
  EXPECT_EQ(taken[1].record, 2U);
  EXPECT_EQ(observations.pool().size(), 2U);
  observations.put_back(std::move(taken), Reason::scans_disagree, ClosureId{7});
  ASSERT_EQ(observations.pool().size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(observations.pool()[i].record, i);
  expect(observations, 2, Verdict::waiting, Reason::scans_disagree);
  EXPECT_EQ(observations.log()[2].closure, ClosureId{7});
}

TEST(MutualObservations, AreRefusedForWhatTheyDoubt) {
  SideBySide scene;
  MutualObservations observations = observations_of(scene, 4);
  observations.doubt(1, Reason::another_tag_is_there);
  observations.refuse({1, 3});
  expect(observations, 1, Verdict::refused, Reason::another_tag_is_there);
  expect(observations, 3, Verdict::refused, Reason::unsupported);
  observations.refuse_pool();
  EXPECT_TRUE(observations.pool().empty());
  expect(observations, 0, Verdict::refused, Reason::unsupported);
}

TEST(MutualObservations, ThatAnotherHasRuledOnAreRemoved) {
  SideBySide scene;
  MutualObservations observations = observations_of(scene, 3);
  const std::vector<Evidence> ruled_on{observations.pool()[1]};
  observations.remove(ruled_on);
  ASSERT_EQ(observations.pool().size(), 2U);
  EXPECT_EQ(observations.pool()[1].record, 2U);
}

TEST(MutualObservations, OfARobotThatIsDroppedWaitNoLonger) {
  SideBySide scene;
  MutualObservations observations = observations_of(scene, 2);
  observations.take(SideBySide::r2_sees_r1(15), "R1", false, 0);
  observations.forget_robot("R1");
  EXPECT_TRUE(observations.pool().empty());
  EXPECT_FALSE(observations.has_work());
  for (const std::size_t i : {0U, 1U, 2U}) expect(observations, i, Verdict::refused, Reason::robot_dropped);
}

TEST(MutualObservations, ThatTheMapHadTakenInAreReopenedFromTheLog) {
  SideBySide scene;
  scene.join();
  MutualObservations observations = observations_of(scene, 2);
  observations.reopen(scene.world(20), {}, std::vector<std::size_t>{1});
  ASSERT_EQ(observations.pool().size(), 1U);
  EXPECT_EQ(observations.pool()[0].target, "R2") << "by the barcode that it wears";
  EXPECT_FALSE(observations.pool()[0].is_tag);
  expect(observations, 1, Verdict::waiting, Reason::unsupported);
}

TEST(MutualObservations, WithoutScansBecomeRelationsThatAreFittedLater) {
  SideBySide scene(Walls{});
  scene.join({25, 25, 1e3});
  const std::size_t before = scene.map.graph().relations().size();
  MutualObservations observations = observations_of(scene, 1);
  expect(observations, 0, Verdict::accepted, Reason::agrees_with_map);
  EXPECT_EQ(scene.map.graph().relations().size(), before + 1);
  EXPECT_TRUE(observations.has_work());
  observations.refit_next(scene.world(16));
  EXPECT_FALSE(observations.has_work());
}

}  // namespace
}  // namespace isthmus
