#include "server/engine/closures/closure_ledger.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "tests/support/side_by_side.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

ClosureDraft draft_of(ClosureId id, bool from_scans, std::int64_t utime = 1) {
  ClosureDraft draft;
  draft.proposal.id = draft.record.id = id;
  draft.record.from_scans = from_scans;
  draft.record.start_utime = draft.record.end_utime = utime;
  return draft;
}

std::vector<Evidence> evidence_of(int count) {
  std::vector<Evidence> evidence(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < evidence.size(); ++i) evidence[i].record = i;
  return evidence;
}

TEST(ClosureLedger, GivesTheIdOfWhatIsStruckToTheNext) {
  ClosureLedger ledger;
  for (int i = 0; i < 3; ++i) ledger.enter(draft_of(ledger.take_id(), false));
  ledger.strike(ClosureId{1});
  ledger.strike(ClosureId{2});
  EXPECT_EQ(ledger.take_id(), ClosureId{2});
  EXPECT_EQ(ledger.take_id(), ClosureId{3}) << "but that of an earlier one to nobody";
  EXPECT_EQ(ledger.find(ClosureId{1}), nullptr);
  EXPECT_EQ(ledger.records().size(), 1U);
}

TEST(ClosureLedger, ContinuesTheRecordOfWhatIsOnTrialOnceMore) {
  ClosureLedger ledger;
  const ClosureId id = ledger.take_id();
  ledger.enter(draft_of(id, true, 5)).record.work_steps = 12;
  ledger.enter(draft_of(id, true, 9));
  EXPECT_EQ(ledger.at(id).record.start_utime, 5);
  EXPECT_EQ(ledger.at(id).record.end_utime, 9);
  EXPECT_EQ(ledger.at(id).record.work_steps, 12);
}

TEST(ClosureLedger, TellsOnceWhatBecameOfWhatWasProposed) {
  ClosureLedger ledger;
  for (const bool from_scans : {false, true}) {
    ClosureLedger::Entry& entry = ledger.enter(draft_of(ledger.take_id(), from_scans));
    ledger.decide(entry, ClosureState::waiting, Reason::one_corridor, 40);
    EXPECT_EQ(entry.record.reason, Reason::one_corridor);
  }
  const std::vector<ClosureOutcome> rulings = ledger.take_outcomes();
  ASSERT_EQ(rulings.size(), 2U);
  for (int i = 0; i < 2; ++i) EXPECT_EQ(rulings[static_cast<std::size_t>(i)].id, ClosureId{i});
  EXPECT_EQ(rulings[1].state, ClosureState::waiting);
  EXPECT_EQ(rulings[1].reason, Reason::one_corridor);
  EXPECT_EQ(rulings[1].value, 40);
  EXPECT_TRUE(ledger.take_outcomes().empty());
}

TEST(ClosureLedger, KnowsTheLoopsOfAnIslandThatItIsLeastSureOf) {
  ClosureLedger ledger;
  RelationGraph graph;
  for (const int patch : {0, 1}) graph.add_patch(PatchId{patch});
  const auto add = [&](int patch, ClosureState state, double log_odds) {
    ClosureDraft draft = draft_of(ledger.take_id(), true);
    draft.record.kind = ClosureKind::loop;
    draft.record.joining.first = PatchId{patch};
    draft.record.account.shared_log_odds = log_odds;
    ledger.decide(ledger.enter(draft), state, Reason::from_scans);
  };
  for (const double sure : {9.0, -2.0, 7.0, 4.0, 8.0}) add(0, ClosureState::accepted, sure);
  add(0, ClosureState::refused, 1);
  add(1, ClosureState::accepted, 1);
  const std::vector<UncertainClosure> found = ledger.closed_loops(graph, IslandId{PatchId{0}});
  ASSERT_EQ(found.size(), 4U) << "a trial looks at so many";
  const int by_doubt[] = {1, 3, 2, 4};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(found[i].id, ClosureId{by_doubt[i]});
  EXPECT_EQ(found[0].log_odds, 0) << "it was accepted";
}

// Loop 0 was hardly sure. What was found later where only a map with it would have it speaks for it.
TEST(ClosureLedger, IsTheSurerOfALoopTheMoreLoopsWereFoundWhereTheMapHadThemByIt) {
  ClosureLedger ledger;
  RelationGraph graph;
  graph.add_patch(PatchId{0});
  const auto add = [&](ClosureState state, TrialAccount account) {
    ClosureDraft draft = draft_of(ledger.take_id(), true);
    draft.record.kind = ClosureKind::loop;
    draft.record.joining.first = PatchId{0};
    draft.record.account = std::move(account);
    ledger.decide(ledger.enter(draft), state, Reason::from_scans);
  };
  const auto of_first = [&] {
    const std::vector<UncertainClosure> all = ledger.closed_loops(graph, IslandId{PatchId{0}});
    return std::ranges::find(all, ClosureId{0}, &UncertainClosure::id)->log_odds;
  };
  const auto found_at = [](double revisit_log_odds, std::vector<ClosureId> rests_on, int blamed = 0) {
    TrialAccount account;
    account.revisit_log_odds = revisit_log_odds;
    account.rests_on = std::move(rests_on);
    account.blamed = blamed;
    return account;
  };
  add(ClosureState::accepted, found_at(2, {}));
  EXPECT_EQ(of_first(), 2);
  add(ClosureState::accepted, found_at(6, {}));
  EXPECT_EQ(of_first(), 2) << "that was found where any map had it";
  add(ClosureState::accepted, found_at(5, {ClosureId{0}}));
  EXPECT_EQ(of_first(), 7);
  EXPECT_EQ(found_at(-3, {}).confirmed_log_odds(), 0)
      << "what is off says that something is wrong, and not what";
  add(ClosureState::waiting, found_at(5, {ClosureId{0}}));
  EXPECT_EQ(of_first(), 7) << "it may be false itself";
  add(ClosureState::accepted, found_at(5, {ClosureId{0}}, 3));
  EXPECT_EQ(of_first(), 7) << "it had the map change before it was where it was found";
}

TEST(ClosureLedger, AllowsWithAClosureWhatScansWereRefusedForItsSake) {
  ClosureLedger ledger;
  ClosureLedger::Entry& forbidden = ledger.enter(draft_of(ledger.take_id(), false));
  forbidden.forbidden = true;
  for (int i = 1; i < 3; ++i) ledger.enter(draft_of(ledger.take_id(), true));
  ledger.at(ClosureId{2}).forbidden_as = ClosureId{0};
  EXPECT_EQ(ledger.forbidden(), (std::vector<ClosureId>{ClosureId{0}})) << "not what says the same";
  ledger.allow(forbidden);
  EXPECT_FALSE(forbidden.forbidden);
  EXPECT_TRUE(ledger.forbidden().empty());
  EXPECT_EQ(forbidden.record.reason, Reason::allowed_again);
  EXPECT_FALSE(ledger.at(ClosureId{2}).forbidden_as.valid());
  const std::vector<ClosureOutcome> rulings = ledger.take_outcomes();
  ASSERT_EQ(rulings.size(), 1U);
  EXPECT_EQ(rulings[0].id, ClosureId{2});
}

TEST(ClosureLedger, KnowsWhatIsForbiddenBeforeItIsProposed) {
  ClosureLedger ledger;
  ledger.forbid_id(ClosureId{4});
  EXPECT_TRUE(ledger.is_forbidden_id(ClosureId{4}));
  EXPECT_TRUE(ledger.allow_id(ClosureId{4}));
  EXPECT_FALSE(ledger.is_forbidden_id(ClosureId{4}));
  EXPECT_FALSE(ledger.allow_id(ClosureId{4}));
}

TEST(ClosureLedger, FindsTheForbiddenClosureThatAMapBringsAbout) {
  SideBySide apart, together;
  together.join();
  ClosureLedger ledger;
  ClosureLedger::Entry& entry = ledger.enter(draft_of(ledger.take_id(), false));
  entry.record.joining = {apart.first[0], apart.second[0], {0, 1.5, 0}, 0.01 * Eigen::Matrix3d::Identity()};
  EXPECT_FALSE(ledger.forbidden_by(apart.map, together.map, {})) << "nobody has forbidden it";
  entry.forbidden = true;
  EXPECT_EQ(ledger.forbidden_by(apart.map, together.map, {}), ClosureId{0});
  EXPECT_FALSE(ledger.forbidden_by(apart.map, apart.map, {}));
}

TEST(ClosureLedger, KeepsTheNewestSightingsThatSayWhatIsForbidden) {
  ClosureLedger ledger;
  const ClosureId id = ledger.take_id();
  ledger.enter(draft_of(id, false), evidence_of(2));
  ledger.keep_with_forbidden(id, evidence_of(399));
  ASSERT_EQ(ledger.at(id).evidence.size(), 400U);
  EXPECT_EQ(ledger.at(id).evidence.front().record, 1U);
  EXPECT_EQ(ledger.at(id).evidence.back().record, 398U);
}

}  // namespace
}  // namespace isthmus
