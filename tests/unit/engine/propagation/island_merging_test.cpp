// Howard et al. 2006, IV-C: the same as a loop closure (IV-B), on two islands that are laid side by side
// first.

#include <gtest/gtest.h>

#include "server/engine/propagation/trial.hpp"
#include "tests/support/poses.hpp"
#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

const Pose rough_error{0.12, -0.08, 0.03};  // by which its rough alignment errs

// Two ways through one room, 0-1-2 and 3-4-5, each on an island of its own, and a sighting of 4 in 1.
struct TwoIslands {
  TwoIslands() {
    add_way(map, furnished_room(), {world[0], world[1], world[2]});
    add_way(map, furnished_room(), {world[3], world[4], world[5]}, second_from_world);
    Relation seen = odometry_relation(PatchId{1}, PatchId{4}, relative(world, 1, 4), {2500, 2500, 1e4});
    seen.kind = RelationKind::relative_pose;
    seen.origin = {OriginKind::sighting, ClosureId{0}};
    proposal.id = ClosureId{0};
    proposal.merge = true;
    proposal.older = PatchId{0};
    proposal.younger = PatchId{3};
    proposal.older_from_younger = rough_error * inverse(second_from_world);
    proposal.relations = {seen};
    proposal.supporters = 6;
    proposal.two_way = true;
  }
  Trial begun() const { return {map, proposal, EngineOptions{}, 0}; }
  Trial accepted() const {
    Trial trial = begun();
    trial.finish(0);
    EXPECT_TRUE(trial.accepted()) << word(trial.refusal());
    return trial;
  }
  template <class Poses>
  static Pose relative(const Poses& poses, int a, int b) {
    return ominus(poses[static_cast<std::size_t>(b)], poses[static_cast<std::size_t>(a)]);
  }

  const std::vector<Pose> world = {{-1, -1.5, 0}, {0.5, -1.4, 0.1}, {1.8, -1, 1.2},
                                   {2, 0.2, 3},   {0.8, 0.1, 3.1},  {-0.5, 0, -3.1}};
  Map map;
  Proposal proposal;
};

// "Prior to merging, we treat the two islands as rigid bodies and bring them into rough alignment."
TEST(IslandMerging, LaysTheYoungerIslandBesideTheOlderAsARigidBody) {
  const TwoIslands islands;
  const Trial trial = islands.begun();
  for (int i = 0; i < 6; ++i) {
    const Pose& truth = islands.world[static_cast<std::size_t>(i)];
    expect_near(trial.map().manifold().pose(PatchId{i}), i < 3 ? truth : rough_error * truth);
  }
}

TEST(IslandMerging, BeginsWithTheRelationThatJoinsThem) {
  const Trial trial = TwoIslands().begun();
  EXPECT_EQ(trial.map().graph().islands().size(), 1U);
  EXPECT_EQ(trial.map().graph().between(PatchId{1}, PatchId{4}).size(), 1U);
}

TEST(IslandMerging, LeavesTheMapAloneUntilItIsAccepted) {
  const TwoIslands islands;
  islands.accepted();
  EXPECT_EQ(islands.map.graph().islands().size(), 2U);
  EXPECT_EQ(islands.map.graph().relations().size(), 4U);
  expect_near(islands.map.manifold().pose(PatchId{3}), second_from_world * islands.world[3]);
}

TEST(IslandMerging, MakesOneIslandInThePlaneOfTheOlder) {
  TwoIslands islands;
  islands.accepted().commit(islands.map);
  ASSERT_EQ(islands.map.graph().islands().size(), 1U);
  EXPECT_EQ(islands.map.graph().island(PatchId{5}), PatchId{0});
  expect_near(islands.map.manifold().pose(PatchId{0}), islands.world[0]);
  for (int i = 1; i < 6; ++i)
    expect_near(islands.map.manifold().pose(PatchId{i}), islands.world[static_cast<std::size_t>(i)], 0.03);
}

TEST(IslandMerging, KeepsAllRelationsAndAddsItsOwn) {
  TwoIslands islands;
  const RelationGraph before = islands.map.graph();
  islands.accepted().commit(islands.map);
  for (const auto& [id, relation] : before.relations()) {
    const Relation* kept = islands.map.graph().find(id);
    ASSERT_NE(kept, nullptr) << id.value;
    EXPECT_EQ(kept->a, relation.a);
    EXPECT_EQ(kept->b, relation.b);
    EXPECT_EQ(kept->origin, relation.origin);
  }
  bool across = false;
  for (const auto& [id, relation] : islands.map.graph().relations()) {
    if (before.find(id)) continue;
    EXPECT_EQ(relation.origin.closure, ClosureId{0}) << "so that it can be taken back";
    across = across || relation.origin.kind == OriginKind::propagation;
  }
  EXPECT_TRUE(across) << "the change was propagated";
}

// The robots go on while it is tried out: what they add to the younger island comes along.
TEST(IslandMerging, CarriesWhatWasMappedMeanwhile) {
  TwoIslands islands;
  const Trial trial = islands.accepted();
  const PatchId late = islands.map.manifold().next_id();
  const Pose step{-0.8, 0.1, 0.2};
  const PatchId last{5};
  islands.map.add(patch_from(furnished_room(), late, islands.world[5] * step),
                  islands.map.manifold().pose(last) * step);
  islands.map.relate(odometry_relation(last, late, step));
  trial.commit(islands.map);
  EXPECT_EQ(islands.map.graph().island(late), PatchId{0});
  expect_near(islands.map.relative_pose(last, late), step);
  expect_near(islands.map.manifold().pose(late), islands.world[5] * step, 0.04);
  EXPECT_EQ(islands.map.graph().between(last, late).size(), 1U);
}

}  // namespace
}  // namespace isthmus
