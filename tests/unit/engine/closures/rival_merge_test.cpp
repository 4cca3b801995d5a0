#include "server/engine/closures/rival_merge.hpp"

#include <gtest/gtest.h>

#include "tests/support/side_by_side.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// R1's and R2's ways on one island by a merge of scans, which two of their patches match for, and a loop that
// scans propose in its stead, with the two ways elsewhere.
struct Rivalled {
  Rivalled() {
    merge = ledger.take_id();
    scene.map.move_island(scene.second.front(), inverse(scene.second_from_world));
    match(scene.first.front(), scene.second.front());
    ClosureRecord& record = enter(merge, ClosureKind::merge, {});
    record.state = ClosureState::accepted;
    record.reason = Reason::from_scans;
  }

  void match(PatchId a, PatchId b) {
    Relation tie = odometry_relation(a, b, scene.map.relative_pose(a, b));
    tie.kind = RelationKind::point_to_point;
    tie.origin = {OriginKind::hypothesis, merge};
    scene.map.relate(tie);
  }
  ClosureRecord& enter(ClosureId id, ClosureKind kind, const Pose& off) {
    ClosureDraft made;
    made.proposal.id = made.record.id = id;
    made.record.kind = kind;
    made.record.from_scans = true;
    made.record.joining.first = scene.first[2];
    made.record.joining.second = scene.second[4];
    made.record.joining.first_from_second = scene.map.relative_pose(scene.first[2], scene.second[4]) * off;
    ClosureRecord& record = ledger.enter(made).record;
    record.account.prior_log_odds = 3;
    return record;
  }
  // By so many metres that match, and so many that do not.
  ClosureRecord& refuse(double way_m, double unmatched_m = 0, const Pose& off = elsewhere) {
    rival = ledger.take_id();
    ClosureRecord& record = enter(rival, ClosureKind::loop, off);
    record.state = ClosureState::refused;
    record.reason = Reason::walls_in_free_space;
    record.account.way_m = way_m;
    record.account.matched = record.account.compared = static_cast<int>(way_m);
    record.account.unmatched_m = unmatched_m;
    return record;
  }
  std::optional<RivalledMerge> found() {
    const TrialOptions& its = scene.options.trial;
    const auto question = doubted_by_scans(ledger, ledger.at(rival), its);
    if (!question) return std::nullopt;
    return rivalled_merge(ledger, ledger.at(rival), partings(scene.map, *question, scene.options), its);
  }

  static constexpr Pose elsewhere{15, 2, 0};
  SideBySide scene;
  ClosureLedger ledger;
  ClosureId merge;
  ClosureId rival;
};

TEST(RivalMerge, IsOneThatMatchesOverMuchMoreWay) {
  Rivalled its;
  its.refuse(40);
  const auto found = its.found();
  ASSERT_TRUE(found);
  EXPECT_EQ(found->merge, its.merge);
  EXPECT_NEAR(found->as_rival, 3 + 0.4 * 40, 1e-9);
  EXPECT_LT(found->as_it_lies, found->as_rival - 7);
}

TEST(RivalMerge, IsNoneThatMatchesOverLittleMore) {
  Rivalled its;
  its.refuse(9);
  EXPECT_FALSE(its.found());
}

// 3 and 0.4 for each metre: 7 is enough to be accepted.
TEST(RivalMerge, IsOneThatWouldBeAcceptedWhereTheMergeWouldNoMore) {
  Rivalled its;
  its.refuse(11);
  const auto found = its.found();
  ASSERT_TRUE(found);
  EXPECT_LT(found->as_rival - found->as_it_lies, 7);
  EXPECT_LT(found->as_it_lies, 7);
}

TEST(RivalMerge, IsNoneWhereHalfOfTheGroundDoesNotMatch) {
  Rivalled its;
  its.refuse(40, 40);
  EXPECT_FALSE(its.found());
}

TEST(RivalMerge, IsHeldAgainstGroundThatBothMapsKnowAndThatDoesNotMatch) {
  Rivalled its;
  its.refuse(40);
  const double counted = its.found()->as_it_lies;
  its.scene.options.trial.log_odds_per_unmatched_m = 0;
  EXPECT_LT(counted, its.found()->as_it_lies - 0.5);
}

TEST(RivalMerge, IsNoneThatDriftExplains) {
  Rivalled its;
  its.refuse(40, 0, {0.3, 0.2, 0.02});
  EXPECT_FALSE(its.found());
}

TEST(RivalMerge, IsHeldAgainstAllThatMatchesSince) {
  Rivalled lies_alone;
  lies_alone.refuse(20);
  const double alone = lies_alone.found()->as_it_lies;
  Rivalled its;
  for (std::size_t i = 1; i < 6; ++i) its.match(its.scene.first[i], its.scene.second[i]);
  its.refuse(20);
  if (const auto found = its.found()) {
    EXPECT_GT(found->as_it_lies, alone + 1);
  }
  its.ledger.at(its.rival).record.account.way_m = 200;
  EXPECT_GT(its.found()->as_it_lies, alone + 1) << "five more patches of either match";
}

TEST(RivalMerge, IsHeldAgainstTheSightingsOfTheMerge) {
  Rivalled its;
  its.refuse(40);
  const double alone = its.found()->as_it_lies;
  its.ledger.at(its.merge).evidence.resize(4);
  EXPECT_NEAR(its.found()->as_it_lies, alone + 2 * TrialOptions{}.log_odds_per_sighting, 1e-9);
}

TEST(RivalMerge, DoesNotUndoAMeasuredStart) {
  Rivalled its;
  its.ledger.at(its.merge).record.reason = Reason::measured_start;
  its.refuse(40);
  EXPECT_FALSE(its.found());
}

TEST(RivalMerge, IsNothingThatSightingsProposeOrThatHardlyMatches) {
  Rivalled its;
  its.refuse(40).from_scans = false;
  EXPECT_FALSE(its.found());
  its.refuse(40).account.matched = 3;
  EXPECT_FALSE(its.found());
  its.refuse(40).account.unmatched_m = 30;
  EXPECT_FALSE(its.found());
}

TEST(RivalMerge, IsNoneOfPatchesThatAreTogetherWithoutTheMerge) {
  Rivalled its;
  its.refuse(40).joining.second = its.scene.first[5];
  EXPECT_FALSE(its.found());
}

}  // namespace
}  // namespace isthmus
