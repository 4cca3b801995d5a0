#include "server/engine/closures/taking_back.hpp"

#include <gtest/gtest.h>

#include "tests/support/side_by_side.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

constexpr ClosureId merging_closure{0};

/// Closure 0 has joined the islands of R1 and R2.
struct JoinedIslands {
  SideBySide scene;
  ClosureLedger ledger;
  MutualObservations observations;
  TagPlacer tags;

  JoinedIslands() {
    scene.map.move_island(scene.second.front(), inverse(scene.second_from_world));
    Relation relation = odometry_relation(scene.first[0], scene.second[0], {0, 1.5, 0});
    relation.origin = {OriginKind::sighting, merging_closure, 0};
    scene.map.relate(relation);
    ClosureDraft draft;
    draft.record.id = ledger.take_id();
    draft.record.joining = {scene.first[0], scene.second[0], {0, 1.4, 0}, Eigen::Matrix3d::Zero()};
    ledger.enter(draft);
  }
  std::vector<PatchId> taken_back() {
    return take_back(scene.world(20), merging_closure, ledger, observations, tags);
  }
};

TEST(TakingBack, PartsIslandsAndNamesThem) {
  JoinedIslands its;
  EXPECT_EQ(its.taken_back(), (std::vector<PatchId>{its.scene.first[0], its.scene.second[0]}));
  EXPECT_EQ(its.scene.map.graph().islands().size(), 2U);
}

TEST(TakingBack, KeepsHowTheMapHadWhatWasJoined) {
  JoinedIslands its;
  its.taken_back();
  EXPECT_NEAR(its.ledger.at(merging_closure).record.joining.first_from_second.y, 1.5, 1e-6);
  EXPECT_GT(its.ledger.at(merging_closure).record.joining.covariance(0, 0), 0);
}

// It was wrong if the closure was right; now the closure is gone.
TEST(TakingBack, GivesBackWhatTheClosureHadTakenOutAsWrong) {
  JoinedIslands its;
  const PatchId a = its.scene.first[1], b = its.scene.first[2];
  Relation blamed = odometry_relation(a, b, its.scene.map.relative_pose(a, b));
  blamed.kind = RelationKind::relative_pose;
  its.ledger.at(merging_closure).blamed = {blamed};
  const std::size_t before = its.scene.map.graph().between(a, b).size();
  its.taken_back();
  EXPECT_EQ(its.scene.map.graph().between(a, b).size(), before + 1);
  EXPECT_TRUE(its.ledger.at(merging_closure).blamed.empty());
}

// The map was sure of the sighting by the closure alone.
TEST(TakingBack, ReopensSightingsThatTheMapHadTakenInByIt) {
  JoinedIslands its;
  its.observations.take(SideBySide::r1_sees_r2(15), "R2", false, 0);
  its.observations.place(its.scene.world(16), {});
  ASSERT_EQ(its.observations.log()[0].verdict, Verdict::accepted);
  const Evidence seen = its.scene.evidence(SideBySide::r1_sees_r2(15), 0);
  its.scene.map.relate(*sighting_relation(its.scene.map, seen, {}, {}, {}));
  its.taken_back();
  EXPECT_EQ(its.observations.log()[0].verdict, Verdict::waiting);
  EXPECT_EQ(its.observations.pool().size(), 1U);
  EXPECT_EQ(its.scene.map.graph().islands().size(), 2U);
}

/// Of R1, when it drove on R2's ground.
struct OneRecordedPlace : RecordedWays {
  PastPlace place;
  std::int64_t since_utime = -1;

  void correct(std::int64_t since, const Change& change) override {
    since_utime = since;
    changed = change("R1", place);
  }
  bool changed = false;
};

TEST(TakingBack, PutsWhatIsWrittenDownOnTheRobotsOwnGround) {
  JoinedIslands its;
  its.ledger.at(merging_closure).record.end_utime = 7;
  OneRecordedPlace recorded;
  recorded.place.utime = SideBySide::utime(15);
  recorded.place.pose = {its.scene.second[4], {0.1, -1.4, 0.2}};
  const Pose before =
      its.scene.map.manifold().pose(its.scene.second[4]) * recorded.place.pose.patch_from_object;
  World world = its.scene.world(20);
  world.recorded = &recorded;
  take_back(world, merging_closure, its.ledger, its.observations, its.tags);
  EXPECT_TRUE(recorded.changed);
  EXPECT_EQ(recorded.since_utime, 7) << "when the closure was accepted";
  const PatchId own = recorded.place.pose.patch;
  ASSERT_EQ(its.scene.map.manifold().patch(own).robot, "R1");
  const Pose after = its.scene.map.manifold().pose(own) * recorded.place.pose.patch_from_object;
  EXPECT_NEAR(std::hypot(after.x - before.x, after.y - before.y), 0, 1e-6);
}

}  // namespace
}  // namespace isthmus
