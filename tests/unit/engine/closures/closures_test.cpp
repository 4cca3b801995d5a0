#include "server/engine/closures/closures.hpp"

#include <gtest/gtest.h>

#include "tests/support/side_by_side.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

constexpr ClosureId first_id{0};

/// R1 and R2, which have seen one another for six seconds.
struct Meeting {
  SideBySide scene;
  Closures closures;
  double now_s = 16;

  Meeting() {
    for (double s = 10; s <= 15; ++s) {
      closures.take(SideBySide::r1_sees_r2(s), "R2", false, SideBySide::utime(s));
      closures.take(SideBySide::r2_sees_r1(s), "R1", false, SideBySide::utime(s));
    }
  }
  World world() { return scene.world(now_s); }
  /// Events a tenth of a second apart, two seconds of them, and until nothing is on trial.
  void work() {
    for (int i = 0; i < 20 || closures.on_trial(); ++i, now_s += 0.1) {
      ASSERT_LT(i, 10'000);
      closures.advance(world());
    }
  }
  std::size_t islands() const { return scene.map.graph().islands().size(); }
  ClosureRecord record(std::size_t i) const { return closures.closures().at(i); }
  std::int64_t count(Verdict verdict) const { return closures.sightings().count(verdict); }
};

TEST(Closures, JoinTheIslandsOfRobotsThatSeeOneAnother) {
  Meeting met;
  met.work();
  ASSERT_EQ(met.closures.closures().size(), 1U);
  EXPECT_EQ(met.record(0).state, ClosureState::accepted) << word(met.record(0).reason);
  EXPECT_EQ(met.record(0).kind, ClosureKind::merge);
  EXPECT_EQ(met.islands(), 1U);
  EXPECT_NEAR(met.scene.map.relative_pose(met.scene.first[3], met.scene.second[3]).y, 1.5, 0.05);
  EXPECT_GE(met.count(Verdict::accepted), 4);
  EXPECT_EQ(met.closures.take_changed(), (std::vector<PatchId>{met.scene.first[0]}));
  EXPECT_TRUE(met.closures.take_changed().empty()) << "it was told";
}

TEST(Closures, LeaveTheMapAloneWhileATrialRuns) {
  Meeting met;
  met.closures.advance(met.world());
  EXPECT_TRUE(met.closures.on_trial());
  EXPECT_TRUE(met.closures.has_work());
  EXPECT_EQ(met.islands(), 2U);
  EXPECT_EQ(met.record(0).state, ClosureState::waiting);
}

TEST(Closures, EndWhatIsOnTrialWhenNoMoreEventsCome) {
  Meeting met;
  met.closures.advance(met.world());
  met.closures.begin_finish(met.world());
  while (met.closures.finish_step(met.world())) {
  }
  EXPECT_EQ(met.record(0).state, ClosureState::accepted);
  EXPECT_EQ(met.count(Verdict::waiting), 0);
}

TEST(Closures, ThatWaitAreTriedBeforeTheEndAndRefusedAtIt) {
  Meeting met;
  met.closures.take(SideBySide::seen("R1", 12, 2, {3, 1}), "R2", false, SideBySide::utime(12));  // misread
  met.closures.begin_finish(met.world());
  while (met.closures.try_waiting(met.world())) {
  }
  EXPECT_EQ(met.islands(), 1U);
  EXPECT_EQ(met.count(Verdict::refused), 0);
  EXPECT_GE(met.count(Verdict::waiting), 1);
  while (met.closures.finish_step(met.world())) {
  }
  EXPECT_GE(met.count(Verdict::refused), 1);
  EXPECT_EQ(met.count(Verdict::waiting), 0);
}

TEST(Closures, TakeBackWhatOperatorsForbidUntilItIsAllowed) {
  Meeting met;
  met.work();
  EXPECT_EQ(met.closures.allow(first_id), DropReason::not_forbidden);
  EXPECT_EQ(met.closures.forbid(met.world(), first_id, true), DropReason::none);
  EXPECT_EQ(met.islands(), 2U);
  EXPECT_EQ(met.record(0).state, ClosureState::withdrawn);
  met.work();
  EXPECT_EQ(met.islands(), 2U) << "nor does it come again";
  EXPECT_EQ(met.closures.allow(first_id), DropReason::none);
  met.work();
  EXPECT_EQ(met.islands(), 1U);
}

TEST(Closures, AreForbiddenBeforeTheyAreProposed) {
  Meeting met;
  EXPECT_EQ(met.closures.forbid(met.world(), first_id, true), DropReason::no_such_closure);
  EXPECT_EQ(met.closures.forbid(met.world(), first_id, false), DropReason::none);
  met.work();
  EXPECT_EQ(met.islands(), 2U);
  EXPECT_EQ(met.record(0).reason, Reason::forbidden);
  EXPECT_EQ(met.closures.allow(ClosureId{7}), DropReason::no_such_closure);
}

TEST(Closures, OnTrialAreNotWithdrawnButMayBeForbidden) {
  Meeting met;
  met.closures.advance(met.world());
  EXPECT_EQ(met.closures.forbid(met.world(), first_id, true), DropReason::not_accepted);
  EXPECT_TRUE(met.closures.on_trial());
  EXPECT_EQ(met.closures.forbid(met.world(), first_id, false), DropReason::none);
  EXPECT_FALSE(met.closures.on_trial());
  EXPECT_EQ(met.record(0).state, ClosureState::refused);
}

TEST(Closures, PutATrialOffWhenARobotsDataIsTakenOut) {
  Meeting met;
  met.closures.advance(met.world());
  met.closures.forget_robot("R2");
  EXPECT_FALSE(met.closures.on_trial());
  EXPECT_TRUE(met.closures.closures().empty()) << "as if it had not been proposed";
  EXPECT_EQ(met.count(Verdict::refused), 12) << "nothing that saw R2, or that it saw, waits any longer";
}

/// Two without lasers: nothing but sightings tells how they lie to one another.
struct MisreadBarcodes {
  SideBySide scene{Walls{}};
  Closures closures;

  /// Each sees the other once, `off` from where it is.
  void see_one_another(double s, const Eigen::Vector2d& off = {0, 0}) {
    const SightingEvent of_r2 = SideBySide::seen("R1", s, 2, SideBySide::r2_at(s) + off);
    const SightingEvent of_r1 = SideBySide::seen("R2", s, 1, SideBySide::r1_at(s) - off);
    closures.take(of_r2, "R2", false, SideBySide::utime(s));
    closures.take(of_r1, "R1", false, SideBySide::utime(s));
  }
  void work(double from_s) {
    for (int i = 0; i < 40 || closures.on_trial(); ++i) {
      ASSERT_LT(i, 10'000);
      closures.advance(scene.world(from_s + 0.1 * i));
    }
  }
  double apart_y() const { return scene.map.relative_pose(scene.first[3], scene.second[3]).y; }
};

TEST(Closures, WithdrawAMergeThatMoreSightingsContradictThanSupport) {
  MisreadBarcodes met;
  for (const double s : {10.0, 12.0, 14.0, 15.0}) met.see_one_another(s, {1, 3});
  met.work(16);
  ASSERT_EQ(met.closures.closures().at(0).state, ClosureState::accepted);
  ASSERT_NEAR(met.apart_y(), 4.5, 0.1) << "nothing has told yet that they are wrong";
  for (const double s : {13.0, 13.1, 13.2, 13.3}) met.see_one_another(s, {1, 3});
  met.work(20);
  for (std::size_t i = 8; i < 16; ++i) ASSERT_EQ(met.closures.sightings()[i].reason, Reason::agrees_with_map);
  for (double s = 10.25; s < 15; s += 0.25) met.see_one_another(s);
  met.work(30);
  EXPECT_EQ(met.closures.closures().at(0).state, ClosureState::withdrawn);
  EXPECT_EQ(met.closures.closures().at(0).reason, Reason::contradicted);
  EXPECT_EQ(met.closures.closures().back().state, ClosureState::accepted);
  EXPECT_EQ(met.scene.map.graph().islands().size(), 1U);
  EXPECT_NEAR(met.apart_y(), 1.5, 0.1);
  for (std::size_t i = 8; i < 16; ++i)
    EXPECT_NE(met.closures.sightings()[i].verdict, Verdict::accepted) << "it agreed with what is no more";
}

TEST(Closures, TellOfEachMergeWhatWasTheSmallerSide) {
  MisreadBarcodes met;
  for (const double s : {10.0, 10.5, 11.0}) met.see_one_another(s);
  met.work(16);
  ASSERT_EQ(met.scene.map.graph().islands().size(), 1U);
  EXPECT_EQ(met.closures.take_merged(), (std::vector<std::vector<PatchId>>{met.scene.second}));
  EXPECT_TRUE(met.closures.take_merged().empty()) << "it was told";
}

TEST(Closures, KeepAMergeThatMoreSightingsSupportThanContradict) {
  MisreadBarcodes met;
  for (const double s : {10.0, 10.5, 11.0}) met.see_one_another(s);
  met.work(16);
  ASSERT_NEAR(met.apart_y(), 1.5, 0.1);
  for (double s = 10.25; s < 15; s += 0.5) met.see_one_another(s);
  met.work(20);
  for (const double s : {13.5, 14.0, 14.5, 15.0}) met.see_one_another(s, {1, 3});
  met.work(30);
  EXPECT_GE(met.closures.closures().size(), 2U) << "they agree with one another, and were tried";
  EXPECT_EQ(met.closures.closures().at(0).state, ClosureState::accepted);
  EXPECT_NEAR(met.apart_y(), 1.5, 0.1);
}

// On one island, which hardly knows how the two lie to one another.
TEST(Closures, WithdrawALoopThatSurerSightingsContradict) {
  for (const bool surer : {true, false}) {
    MisreadBarcodes met;
    met.scene.join({0.1, 0.1, 1});
    for (const double s : {10.0, 12.0, 14.0}) met.see_one_another(s, {1, 3});
    met.work(16);
    ASSERT_EQ(met.closures.closures().at(0).kind, ClosureKind::loop);
    ASSERT_EQ(met.closures.closures().at(0).state, ClosureState::accepted);
    ASSERT_NEAR(met.apart_y(), 4.5, 0.1) << "nothing has told yet that they are wrong";
    const double step_s = surer ? 0.25 : 2.5;
    for (double s = 10.25; s < 15; s += step_s) met.see_one_another(s);
    met.work(30);
    ASSERT_GE(met.closures.closures().size(), 2U) << "they agree with one another, and were tried";
    const ClosureRecord first = met.closures.closures().at(0), second = met.closures.closures().at(1);
    EXPECT_EQ(first.state, surer ? ClosureState::withdrawn : ClosureState::accepted) << word(second.reason);
    EXPECT_NEAR(met.apart_y(), surer ? 1.5 : 4.5, 0.1);
    if (!surer) continue;
    EXPECT_EQ(first.reason, Reason::contradicted);
    EXPECT_EQ(second.state, ClosureState::accepted);
    EXPECT_EQ(second.account.blamed_closure, first.id);
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NE(met.closures.sightings()[i].verdict, Verdict::accepted) << i;
  }
}

// Nobody has agreed with it since it was made, but more made it than contradict it.
TEST(Closures, KeepAMergeThatIsMadeOfMoreThanContradictIt) {
  MisreadBarcodes met;
  for (double s = 10; s <= 13; s += 0.5) met.see_one_another(s);
  met.work(16);
  ASSERT_NEAR(met.apart_y(), 1.5, 0.1);
  for (const double s : {13.5, 14.0, 14.5, 15.0}) met.see_one_another(s, {1, 3});
  met.work(30);
  EXPECT_GE(met.closures.closures().size(), 2U) << "they agree with one another, and were tried";
  EXPECT_EQ(met.closures.closures().at(0).state, ClosureState::accepted);
  EXPECT_NEAR(met.apart_y(), 1.5, 0.1);
}

/// What scans say of the same.
ScanProposal from_scans(const SideBySide& scene) {
  ScanProposal finds;
  finds.first = scene.first[0];
  finds.second = scene.second[0];
  finds.first_from_second = {0, 1.5, 0};
  for (const std::size_t i : {0U, 3U, 5U})
    finds.relations.push_back(odometry_relation(scene.first[i], scene.second[i], {0, 1.5, 0}));
  finds.finds = 3;
  finds.robots = {"R1", "R2"};
  return finds;
}

TEST(Closures, TellScansWhatBecameOfTheirProposals) {
  SideBySide scene;
  Closures closures;
  const ClosureId id = closures.propose_from_scans(scene.world(20), from_scans(scene));
  EXPECT_TRUE(closures.on_trial());
  EXPECT_TRUE(closures.take_outcomes().empty());
  while (closures.step_trial(scene.world(20))) {
  }
  const std::vector<ClosureOutcome> outcomes = closures.take_outcomes();
  ASSERT_EQ(outcomes.size(), 1U);
  EXPECT_EQ(outcomes[0].id, id);
  EXPECT_EQ(outcomes[0].state, ClosureState::waiting);
  EXPECT_EQ(outcomes[0].reason, Reason::too_little_support) << "three metres of way say little";
  EXPECT_TRUE(closures.take_outcomes().empty()) << "it was told";
}

TEST(Closures, FromScansAreRefusedByWhatRefutesThem) {
  SideBySide scene;
  Closures closures;
  const ClosureId id = closures.propose_from_scans(scene.world(20), from_scans(scene));
  closures.refuse_from_scans(id, Reason::met_nobody);
  EXPECT_FALSE(closures.on_trial());
  EXPECT_EQ(closures.closures().at(0).state, ClosureState::refused);
  EXPECT_EQ(closures.closures().at(0).reason, Reason::met_nobody);
  EXPECT_EQ(scene.map.graph().islands().size(), 2U);
}

/// A merge by misread barcodes, and a loop that says otherwise and was refused just now.
struct Doubted : MisreadBarcodes {
  double now_s = 20;

  Doubted() {
    for (const double s : {10.0, 12.0, 14.0, 15.0}) see_one_another(s, {1, 3});
    work(16);
    for (double s = 10.25; s < 15; s += 0.25) see_one_another(s);
    while (closures.closures().size() < 2 || closures.on_trial()) advance();
  }
  void advance() {
    now_s += 0.01;
    closures.advance(scene.world(now_s));
  }
  void advance_by_a_second() {
    now_s += 1;
    advance();
  }
  ClosureRecord merge() const { return closures.closures().at(0); }
};

TEST(Closures, KeepAMergeThatIsDoubtedUntilWhatHangsOnItIsKnown) {
  Doubted met;
  EXPECT_EQ(met.merge().state, ClosureState::accepted) << "what would go with it is looked for in a thread";
  EXPECT_TRUE(met.closures.has_work());
  met.advance_by_a_second();
  EXPECT_EQ(met.merge().state, ClosureState::withdrawn);
}

TEST(Closures, KeepAMergeThatIsDoubtedWhileAnythingIsOnTrial) {
  Doubted met;
  met.closures.propose_from_scans(met.scene.world(met.now_s), from_scans(met.scene));
  met.now_s += 1;
  int advanced = 0;
  for (met.advance(); met.closures.on_trial(); met.advance(), ++advanced)
    ASSERT_EQ(met.merge().state, ClosureState::accepted);
  EXPECT_GT(advanced, 0);
  EXPECT_EQ(met.merge().state, ClosureState::withdrawn);
}

TEST(Closures, AskAnewWhatHangsOnADoubtedMergeOnceTheMapIsAnother) {
  Doubted met;
  met.closures.forget_robot("R3");
  met.advance_by_a_second();
  EXPECT_EQ(met.merge().state, ClosureState::accepted);
  EXPECT_TRUE(met.closures.has_work());
  met.advance_by_a_second();
  EXPECT_EQ(met.merge().state, ClosureState::withdrawn);
}

TEST(Closures, SettleAtTheEndWhatIsDoubted) {
  Doubted met;
  met.closures.begin_finish(met.scene.world(met.now_s));
  while (met.closures.try_waiting(met.scene.world(met.now_s))) {
  }
  EXPECT_EQ(met.merge().state, ClosureState::withdrawn);
  EXPECT_NEAR(met.apart_y(), 1.5, 0.1);
}

}  // namespace
}  // namespace isthmus
