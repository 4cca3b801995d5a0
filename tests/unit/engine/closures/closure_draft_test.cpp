#include "server/engine/closures/closure_draft.hpp"

#include <gtest/gtest.h>

#include "server/engine/closures/scan_proposal.hpp"
#include "tests/support/side_by_side.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

constexpr ClosureId closure_id{3};
constexpr std::int64_t drafted_utime = 70'000'000;

Relation start_between(PatchId a, PatchId b) {
  Relation relation = odometry_relation(a, b, {0.5, -1, 0.2});
  relation.origin = {OriginKind::start, {}};
  return relation;
}

TEST(ClosureDraft, OfAMeasuredStartPutsTheYoungerIslandWhereItIsMeasured) {
  for (const bool from_the_younger : {false, true}) {
    SideBySide scene;
    const PatchId a = from_the_younger ? scene.second[1] : scene.first[1];
    const PatchId b = from_the_younger ? scene.first[2] : scene.second[2];
    const ClosureDraft draft =
        draft_of_start(scene.map, closure_id, start_between(a, b), {"R1", "R2"}, drafted_utime);
    EXPECT_TRUE(draft.proposal.merge);
    EXPECT_TRUE(draft.proposal.measured);
    EXPECT_EQ(draft.proposal.older, scene.first[0]);
    EXPECT_EQ(draft.proposal.younger, scene.second[0]);
    EXPECT_EQ(draft.proposal.relations.at(0).origin, (Origin{OriginKind::start, closure_id}));
    scene.map.move_island(draft.proposal.younger, draft.proposal.older_from_younger);
    const Pose a_from_b = scene.map.relative_pose(a, b);
    EXPECT_NEAR(a_from_b.x, 0.5, 1e-9);
    EXPECT_NEAR(a_from_b.y, -1, 1e-9);
    EXPECT_NEAR(a_from_b.yaw, 0.2, 1e-9);
  }
}

TEST(ClosureDraft, RecordsThatItWaitsSinceNow) {
  SideBySide scene;
  const Relation start = start_between(scene.first[0], scene.second[0]);
  const ClosureRecord record =
      draft_of_start(scene.map, closure_id, start, {"R2", "R1"}, drafted_utime).record;
  EXPECT_EQ(record.id, closure_id);
  EXPECT_EQ(record.kind, ClosureKind::merge);
  EXPECT_EQ(record.state, ClosureState::waiting);
  EXPECT_EQ(record.reason, Reason::measured_start);
  EXPECT_EQ(record.robots, (std::vector<std::string>{"R2", "R1"}));
  EXPECT_EQ(record.start_utime, drafted_utime);
  EXPECT_EQ(record.end_utime, drafted_utime);
}

TEST(ClosureDraft, OfFindsOnOneIslandIsALoopByScans) {
  SideBySide scene;
  ScanProposal finds;
  finds.first = scene.first[0];
  finds.second = scene.first[5];
  finds.first_from_second = {2.4, 0.1, 0};
  finds.relations = {odometry_relation(finds.first, finds.second, finds.first_from_second)};
  finds.finds = 4;
  finds.cautious = true;
  finds.look_alikes = 3;
  const ClosureDraft draft = draft_of_finds(scene.map, closure_id, finds, drafted_utime, {});
  EXPECT_FALSE(draft.proposal.merge);
  EXPECT_TRUE(draft.proposal.from_scans);
  EXPECT_TRUE(draft.proposal.cautious);
  EXPECT_EQ(draft.proposal.supporters, 4);
  EXPECT_EQ(draft.proposal.look_alikes, 3);
  EXPECT_EQ(draft.proposal.relations.at(0).origin, (Origin{OriginKind::hypothesis, closure_id}));
  EXPECT_EQ(draft.record.kind, ClosureKind::loop);
  EXPECT_EQ(draft.record.reason, Reason::on_trial);
  EXPECT_EQ(draft.record.joining.first_from_second, finds.first_from_second);
}

TEST(ClosureDraft, OfSightingsHasARelationForEach) {
  SideBySide scene;
  const std::vector<Evidence> supporters = {scene.evidence(SideBySide::r1_sees_r2(11), 4),
                                            scene.evidence(SideBySide::r2_sees_r1(12), 5)};
  const SightingGroup group = groups_of(scene.map, supporters, {}).at(0);
  GroupAgreement agreement;
  agreement.older_from_younger = inverse(scene.second_from_world);
  agreement.two_way = true;
  const ClosureDraft draft =
      draft_of_sightings(scene.map, closure_id, group, agreement, supporters, drafted_utime, {});
  ASSERT_EQ(draft.proposal.relations.size(), 2U);
  EXPECT_EQ(draft.proposal.relations[1].origin, (Origin{OriginKind::sighting, closure_id, 5}));
  EXPECT_TRUE(draft.proposal.two_way);
  EXPECT_EQ(draft.proposal.supporters, 2);
  EXPECT_EQ(draft.proposal.older_from_younger, agreement.older_from_younger);
  EXPECT_EQ(draft.record.reason, Reason::none);
  EXPECT_EQ(draft.record.utime, SideBySide::utime(11));
  EXPECT_EQ(draft.record.robots, (std::vector<std::string>{"R1", "R2"}));
}

}  // namespace
}  // namespace isthmus
