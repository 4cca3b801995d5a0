#include "server/engine/closures/closure_ledger.hpp"

#include <gtest/gtest.h>

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

TEST(ClosureLedger, TellsScansWhatBecameOfWhatTheyProposed) {
  ClosureLedger ledger;
  for (const bool from_scans : {false, true}) {
    ClosureLedger::Entry& entry = ledger.enter(draft_of(ledger.take_id(), from_scans));
    ledger.decide(entry, ClosureState::waiting, Reason::one_corridor, 40);
    EXPECT_EQ(entry.record.reason, Reason::one_corridor);
  }
  const std::vector<ClosureOutcome> rulings = ledger.take_outcomes();
  ASSERT_EQ(rulings.size(), 1U);
  EXPECT_EQ(rulings[0].id, ClosureId{1});
  EXPECT_EQ(rulings[0].state, ClosureState::waiting);
  EXPECT_EQ(rulings[0].reason, Reason::one_corridor);
  EXPECT_EQ(rulings[0].value, 40);
  EXPECT_TRUE(ledger.take_outcomes().empty());
}

TEST(ClosureLedger, AllowsWithAClosureWhatScansWereRefusedForItsSake) {
  ClosureLedger ledger;
  ClosureLedger::Entry& forbidden = ledger.enter(draft_of(ledger.take_id(), false));
  forbidden.forbidden = true;
  for (int i = 1; i < 3; ++i) ledger.enter(draft_of(ledger.take_id(), true));
  ledger.at(ClosureId{2}).forbidden_as = ClosureId{0};
  ledger.allow(forbidden);
  EXPECT_FALSE(forbidden.forbidden);
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
