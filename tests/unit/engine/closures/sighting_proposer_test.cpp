#include "server/engine/closures/sighting_proposer.hpp"

#include <gtest/gtest.h>

#include <utility>

#include "tests/support/side_by_side.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

/// Two islands, and what R1 and R2 have seen of one another.
struct Proposing {
  SideBySide scene;
  std::vector<Evidence> pool;
  SightingProposer proposer;

  void see(const SightingEvent& sighting) { pool.push_back(scene.evidence(sighting, pool.size())); }
  void see_one_another(double s) {
    see(SideBySide::r1_sees_r2(s));
    see(SideBySide::r2_sees_r1(s));
  }
  std::optional<GroupAgreement> look() {
    const std::vector<SightingGroup> groups = groups_of(scene.map, pool, {});
    return proposer.look_at(scene.world(60), pool, groups.at(0));
  }
};

TEST(SightingProposer, FindsHowTheIslandsLieByTheSightingsThatAgree) {
  Proposing its;
  its.see_one_another(10);
  its.see(SideBySide::seen("R1", 12, 2, {3, -1}));  // a misread barcode
  its.see_one_another(14);
  const std::optional<GroupAgreement> agreement = its.look();
  ASSERT_TRUE(agreement);
  EXPECT_EQ(agreement->supporters, (std::set<std::size_t>{0, 1, 3, 4}));
  EXPECT_TRUE(agreement->two_way);
  const Pose off = agreement->older_from_younger * its.scene.second_from_world;
  EXPECT_NEAR(off.x, 0, 1e-3);
  EXPECT_NEAR(off.y, 0, 1e-3);
  EXPECT_NEAR(off.yaw, 0, 1e-3);
}

TEST(SightingProposer, SaysHowThePatchesOfTheFirstSightingWouldLie) {
  Proposing its;
  its.see_one_another(12);
  its.see_one_another(14);
  const std::optional<GroupAgreement> agreement = its.look();
  ASSERT_TRUE(agreement);
  EXPECT_EQ(agreement->joining.first, its.scene.first[2]);
  EXPECT_EQ(agreement->joining.second, its.scene.second[2]);
  EXPECT_NEAR(agreement->joining.first_from_second.y, 1.5, 1e-3);
  EXPECT_GT(agreement->joining.covariance(1, 1), 0);
}

TEST(SightingProposer, LooksAgainOnlyAtWhatIsNew) {
  Proposing its;
  its.see_one_another(10);
  its.see_one_another(14);
  EXPECT_TRUE(its.look());
  EXPECT_FALSE(its.look());
  its.see(SideBySide::r1_sees_r2(15));
  EXPECT_TRUE(its.look());
  EXPECT_FALSE(its.look());
  its.proposer.forget();
  EXPECT_TRUE(its.look());
}

TEST(SightingProposer, AsksForHalfAsManyAgainAfterATrial) {
  Proposing its;
  its.see_one_another(10);
  its.proposer.note_trial(IslandPair{its.scene.first[0], its.scene.second[0]}, 2);
  its.see(SideBySide::r1_sees_r2(12));
  EXPECT_FALSE(its.look());
  its.see(SideBySide::r2_sees_r1(12));
  EXPECT_TRUE(its.look());
}

TEST(SightingProposer, OfIslandsThatAreAsTheyWereAsksNothingAgain) {
  Proposing its;
  its.see_one_another(10);
  its.see_one_another(14);
  const PatchId older = its.scene.first[0], younger = its.scene.second[0];
  its.proposer.note_trial(IslandPair{older, younger}, 4);
  EXPECT_FALSE(its.look());
  its.proposer.forget(PatchId{20}, PatchId{30});
  EXPECT_FALSE(its.look()) << "others have merged";
  for (const auto& [one, other] : {std::pair{older, PatchId{30}}, std::pair{PatchId{30}, younger}}) {
    its.proposer.note_trial(IslandPair{older, younger}, 4);
    its.proposer.forget(one, other);
    EXPECT_TRUE(its.look()) << "one of them has grown";
  }
}

TEST(SightingProposer, ComparesNoMoreThanTwoDozen) {
  Proposing its;
  for (int i = 0; i < 20; ++i) its.see_one_another(10 + i % 6);
  const std::optional<GroupAgreement> agreement = its.look();
  ASSERT_TRUE(agreement);
  EXPECT_EQ(agreement->supporters.size(), 24U);
  EXPECT_TRUE(agreement->supporters.contains(39)) << "the newest is among them";
}

TEST(SightingProposer, TakesATagsPlaceForALoop) {
  Proposing its;
  const PatchId patch = its.scene.map.manifold().next_id();
  its.scene.map.add(make_tag_patch(patch, 50, 0), {6, 6, 0});  // the map has it elsewhere
  its.scene.map.relate(odometry_relation(its.scene.first[0], patch, {8, 7.5, 0}));
  for (const double s : {10, 12, 14}) {
    its.see(SideBySide::seen("R1", s, 50, {1, 1}));
    its.pool.back().is_tag = true;
    its.pool.back().target = tag_name(50);
    its.pool.back().target_place = PastPlace{0, 0, {patch, {}}, Eigen::Matrix3d::Zero(), {}};
  }
  const std::optional<GroupAgreement> agreement = its.look();
  ASSERT_TRUE(agreement);
  EXPECT_EQ(agreement->supporters.size(), 3U);
  EXPECT_TRUE(agreement->joining.point);
  EXPECT_EQ(agreement->joining.second, patch);
  EXPECT_NEAR(agreement->joining.first_from_second.x, 3, 1e-6) << "as seen from patch 0";
  EXPECT_NEAR(agreement->joining.first_from_second.y, 2.5, 1e-6);
}

}  // namespace
}  // namespace isthmus
