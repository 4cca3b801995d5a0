#include "server/engine/closures/merge_account.hpp"

#include <gtest/gtest.h>

#include "tests/support/side_by_side.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// R1's and R2's ways on one island by a merge alone, which three sightings were for, and loops across it that
// were refused.
struct Merged {
  Merged() {
    merge = ledger.take_id();
    scene.map.move_island(scene.second.front(), inverse(scene.second_from_world));
    Relation tie = odometry_relation(scene.first.front(), scene.second.front(), {0, 1.5, 0});
    tie.origin = {OriginKind::sighting, merge};
    scene.map.relate(tie);
    ledger.enter(draft(merge, ClosureKind::merge, scene.first[0], scene.second[0]), evidence(3));
    ledger.at(merge).record.state = ClosureState::accepted;
  }

  static ClosureDraft draft(ClosureId id, ClosureKind kind, PatchId first, PatchId second) {
    ClosureDraft made;
    made.proposal.id = made.record.id = id;
    made.record.kind = kind;
    made.record.joining.first = first;
    made.record.joining.second = second;
    return made;
  }
  std::vector<Evidence> evidence(int count) {
    std::vector<Evidence> all(static_cast<std::size_t>(count));
    for (Evidence& one : all) one.record = records++;
    return all;
  }
  const ClosureLedger::Entry& refuse(PatchId first, PatchId second, int sightings,
                                     Reason reason = Reason::scans_disagree) {
    return refuse(ClosureKind::loop, first, second, evidence(sightings), reason);
  }
  const ClosureLedger::Entry& refuse(ClosureKind kind, PatchId first, PatchId second,
                                     std::vector<Evidence> of, Reason reason = Reason::scans_disagree) {
    const ClosureId id = ledger.take_id();
    ClosureLedger::Entry& entry = ledger.enter(draft(id, kind, first, second), std::move(of));
    entry.record.state = ClosureState::refused;
    entry.record.reason = reason;
    return entry;
  }
  std::optional<MergeAccount> account(const ClosureLedger::Entry& refused) {
    const auto question = doubted_by_sightings(ledger, refused);
    if (!question) return std::nullopt;
    return contradicted_merge(scene.world(20), {}, ledger, {}, partings(scene.map, *question, scene.options));
  }

  SideBySide scene;
  ClosureLedger ledger;
  ClosureId merge;
  std::size_t records = 0;
  double per_sighting = TrialOptions{}.log_odds_per_sighting;
};

TEST(MergeAccount, HoldsAMergeForContradictedBySightingsThatNeedItsIslandsApart) {
  Merged merged;
  const auto found = merged.account(merged.refuse(merged.scene.first[2], merged.scene.second[4], 4));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->merge, merged.merge);
  EXPECT_EQ(found->supporting, merged.per_sighting * 1);
  EXPECT_EQ(found->contradicting, merged.per_sighting * 2);
}

TEST(MergeAccount, KeepsAMergeThatAsManySupport) {
  Merged merged;
  EXPECT_FALSE(merged.account(merged.refuse(merged.scene.first[2], merged.scene.second[4], 3)));
}

TEST(MergeAccount, CountsWhatMatchedOnItsTrialForAMerge) {
  Merged merged;
  merged.ledger.at(merged.merge).record.account.shared_log_odds = merged.per_sighting;
  EXPECT_FALSE(merged.account(merged.refuse(merged.scene.first[2], merged.scene.second[4], 4)));
}

TEST(MergeAccount, HasAWholeBuildingThatMatchesOverruledBySightingsAsItMayBeTheSameTwice) {
  Merged merged;
  merged.ledger.at(merged.merge).record.account.shared_log_odds = 1000;
  EXPECT_TRUE(merged.account(merged.refuse(merged.scene.first[2], merged.scene.second[4], 7)));
}

TEST(MergeAccount, TakesWallsInFreeSpaceFromWhatMatched) {
  Merged merged;
  merged.ledger.at(merged.merge).record.account.shared_log_odds = merged.per_sighting;
  merged.ledger.at(merged.merge).record.account.fit_log_odds = -merged.per_sighting;
  EXPECT_TRUE(merged.account(merged.refuse(merged.scene.first[2], merged.scene.second[4], 4)));
}

TEST(MergeAccount, AddsUpAllLoopsThatTheMergeStandsInTheWayOf) {
  Merged merged;
  merged.refuse(merged.scene.first[1], merged.scene.second[1], 2);
  const auto found = merged.account(merged.refuse(merged.scene.first[2], merged.scene.second[4], 2));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->contradicting, merged.per_sighting * 2);
}

TEST(MergeAccount, LeavesOutWhatWasRefusedAsAMergeOfTheTwo) {
  Merged merged;
  const auto& refused = merged.refuse(merged.scene.first[2], merged.scene.second[4], 4);
  merged.refuse(ClosureKind::merge, merged.scene.first[2], merged.scene.second[4], refused.evidence);
  EXPECT_FALSE(merged.account(refused)) << "or the two would be parted for it again and again";
}

TEST(MergeAccount, LeavesAMergeAloneThatTheLoopDoesNotNeedUndone) {
  Merged merged;
  merged.refuse(merged.scene.first[2], merged.scene.second[4], 5);
  EXPECT_FALSE(merged.account(merged.refuse(merged.scene.first[1], merged.scene.first[4], 1)))
      << "both its ends are R1's, with or without the merge";
}

TEST(MergeAccount, HearsLoopsOnlyThatATrialHasRefused) {
  Merged merged;
  EXPECT_FALSE(
      merged.account(merged.refuse(merged.scene.first[2], merged.scene.second[4], 5, Reason::forbidden)));
}

}  // namespace
}  // namespace isthmus
