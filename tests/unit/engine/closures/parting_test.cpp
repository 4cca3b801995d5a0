#include "server/engine/closures/parting.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "tests/support/side_by_side.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

constexpr ClosureId merge_id{3};

// R1's and R2's ways on one island, by a merge and what it made possible to match.
struct JoinedByAMerge {
  JoinedByAMerge() {
    scene.map.move_island(scene.second.front(), inverse(scene.second_from_world));
    for (const std::size_t i : {0U, 2U}) {
      Relation tie = relation(scene.first[i], scene.second[i]);
      tie.origin = {i == 0 ? OriginKind::hypothesis : OriginKind::propagation, merge_id};
      scene.map.relate(tie);
    }
  }
  Relation relation(PatchId a, PatchId b) const {
    return odometry_relation(a, b, scene.map.relative_pose(a, b));
  }
  PartingQuestion question(PatchId a, PatchId b) const {
    PartingQuestion asked;
    asked.joining = {a, b, scene.map.relative_pose(a, b)};
    asked.merges = {merge_id};
    return asked;
  }
  std::vector<Parting> asked(const PartingQuestion& question) const {
    return partings(scene.map, question, scene.options);
  }

  SideBySide scene;
};

TEST(Parting, IsByAMergeThatAloneHoldsTheEndsOnOneIsland) {
  const JoinedByAMerge its;
  const std::vector<Parting> found = its.asked(its.question(its.scene.first[1], its.scene.second[4]));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].merge, merge_id);
  EXPECT_TRUE(found[0].has_apart(its.scene.map.graph(), its.scene.first[5], its.scene.second[0]));
  EXPECT_FALSE(found[0].has_apart(its.scene.map.graph(), its.scene.first[5], its.scene.first[0]));
}

TEST(Parting, IsByNoMergeThatWasNotAskedOfNorWhereAnotherRelationHoldsThem) {
  JoinedByAMerge its;
  PartingQuestion of_another = its.question(its.scene.first[1], its.scene.second[4]);
  of_another.merges = {ClosureId{4}};
  EXPECT_TRUE(its.asked(of_another).empty());
  EXPECT_TRUE(its.asked(its.question(its.scene.first[1], its.scene.first[4])).empty());
  its.scene.map.relate(its.relation(its.scene.first[5], its.scene.second[5]));
  EXPECT_TRUE(its.asked(its.question(its.scene.first[1], its.scene.second[4])).empty());
}

TEST(Parting, IsNotAskedOfWhatDriftExplainsWhereOnlyTheRestIs) {
  const JoinedByAMerge its;
  PartingQuestion question = its.question(its.scene.first[1], its.scene.second[4]);
  question.only_elsewhere = true;
  EXPECT_TRUE(its.asked(question).empty());
  question.joining.first_from_second = question.joining.first_from_second * Pose{15, 2, 0};
  EXPECT_EQ(its.asked(question).size(), 1U);
}

TEST(Parting, HasPatchesThatCameSinceWhereTheirFirstRelationTiesThem) {
  JoinedByAMerge its;
  const std::vector<Parting> found = its.asked(its.question(its.scene.first[1], its.scene.second[4]));
  ASSERT_EQ(found.size(), 1U);
  PatchId newest = its.scene.second.back();
  for (int i = 0; i < 3; ++i) {
    const Manifold& manifold = its.scene.map.manifold();
    auto patch = std::make_shared<Patch>(manifold.patch(newest));
    patch->id = manifold.next_id();
    its.scene.map.add(patch, manifold.pose(newest));
    its.scene.map.relate(its.relation(newest, patch->id));
    newest = patch->id;
  }
  its.scene.map.relate(its.relation(its.scene.first.back(), newest));
  EXPECT_TRUE(found[0].has_apart(its.scene.map.graph(), its.scene.first[0], newest));
  EXPECT_FALSE(found[0].has_apart(its.scene.map.graph(), its.scene.second[0], newest));
}

TEST(PartingsJob, IsDueTheLaterTheLargerTheMapIs) {
  const JoinedByAMerge its;
  const PartingsJob job(its.scene.map, its.question(its.scene.first[1], its.scene.second[4]), 1'000'000,
                        its.scene.options);
  const std::int64_t took_us = 12 * its.scene.options.place_candidates.us_per_patch;
  EXPECT_FALSE(job.is_due(1'000'000 + took_us - 1));
  EXPECT_TRUE(job.is_due(1'000'000 + took_us));
  EXPECT_EQ(job.partings().size(), 1U) << "who asks earlier waits";
}

}  // namespace
}  // namespace isthmus
