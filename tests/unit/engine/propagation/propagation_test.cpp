#include "server/engine/propagation/propagation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

constexpr Origin of_closure{OriginKind::propagation, ClosureId{7}};

const std::vector<Pose> first_drive = {{-1, -1.5, 0}, {0.5, -1.4, 0.1}, {1.8, -1, 0.4}};
const std::vector<Pose> second_drive = {{-0.8, -1.2, 0.1}, {0.6, -1.1, 0}, {1.7, -0.8, 0.3}};

Relation sighting_relation(PatchId a, PatchId b, const Pose& a_from_b) {
  Relation relation = odometry_relation(a, b, a_from_b, {400, 400, 1600});
  relation.kind = RelationKind::relative_pose;
  relation.origin = {OriginKind::sighting, ClosureId{7}};
  return relation;
}

// Two ways through one room, 0-1-2 and 3-4-5, on islands of their own until a relation that is a little off
// ties 1 to 4: step 1 of IV-B.
struct TwoWays {
  TwoWays() : TwoWays(crooked_room(), first_drive, crooked_room(), second_drive) {}
  TwoWays(const Walls& of_first, const std::vector<Pose>& first, const Walls& of_second,
          const std::vector<Pose>& second) {
    add_way(map, of_first, first);
    add_way(map, of_second, second, off);
    world.insert(world.end(), first.begin(), first.end());
    world.insert(world.end(), second.begin(), second.end());
    before = map.graph();
    const PatchId a{1}, b{4};
    map.relate(sighting_relation(a, b, map.relative_pose(a, b)));
  }
  // How 1 truly lies to 4.
  void tell_sharply() {
    Relation sharp = sighting_relation(PatchId{1}, PatchId{4}, {});
    sharp.measurement = RelativePose{ominus(world[4], world[1]), Eigen::Vector3d(1e6, 1e6, 1e7).asDiagonal()};
    map.relate(sharp);
    map.refit_island(PatchId{0});
  }
  Propagation begun() const { return {before, of_closure}; }
  bool stepped(Propagation& propagation) { return propagation.step(map, options); }
  void run(Propagation& propagation) {
    while (!propagation.done()) stepped(propagation);
  }
  // How far b lies from where it truly is, seen from a.
  double error_m(int a, int b) const {
    const auto at = [](int id) { return static_cast<std::size_t>(id); };
    const Pose truth = ominus(world[at(b)], world[at(a)]);
    const Pose mapped = map.relative_pose(PatchId{a}, PatchId{b});
    return std::hypot(mapped.x - truth.x, mapped.y - truth.y);
  }

  const Pose off{0.15, -0.1, 0.03};  // by which the sighting errs
  EngineOptions options;
  Map map;
  RelationGraph before;
  std::vector<Pose> world;
};

std::vector<Relation> induced(const Map& map) {
  std::vector<Relation> found;
  for (const auto& [id, relation] : map.graph().relations())
    if (relation.origin.kind == OriginKind::propagation) found.push_back(relation);
  return found;
}

// Steps 3 and 4: across the border alone; what is on the patch's own side was related before, as far as it
// is.
TEST(Propagation, RelatesAPatchToThoseBeyondTheBorder) {
  TwoWays ways;
  Propagation propagation = ways.begun();
  propagation.enqueue(PatchId{1}, {});
  EXPECT_FALSE(propagation.done());
  EXPECT_TRUE(ways.stepped(propagation));
  const std::vector<Relation> found = induced(ways.map);
  ASSERT_FALSE(found.empty());
  for (const Relation& relation : found) {
    EXPECT_GE(relation.a, PatchId{3});
    EXPECT_EQ(relation.b, PatchId{1});
    EXPECT_EQ(relation.kind, RelationKind::point_to_line);
    EXPECT_EQ(relation.origin, of_closure);
    EXPECT_LT(ways.error_m(1, relation.a.value), 0.05);
  }
  EXPECT_EQ(propagation.matched(), std::vector<PatchId>{PatchId{1}});
  EXPECT_TRUE(propagation.unmatched().empty());
  EXPECT_EQ(propagation.steps(), 1);
}

// Step 4: "eliminate those that are already in the map".
TEST(Propagation, FindsNothingNewTheSecondTime) {
  TwoWays ways;
  Propagation propagation = ways.begun();
  propagation.enqueue(PatchId{1}, {});
  ways.run(propagation);
  std::set<std::pair<PatchId, PatchId>> pairs;
  for (const Relation& relation : induced(ways.map)) {
    const auto pair = std::minmax(relation.a, relation.b);
    EXPECT_TRUE(pairs.insert({pair.first, pair.second}).second)
        << relation.a.value << " and " << relation.b.value << " twice";
  }
  const std::size_t relations = ways.map.graph().relations().size();
  propagation.forget_visits();
  propagation.enqueue(PatchId{1}, {});
  EXPECT_FALSE(ways.stepped(propagation));
  EXPECT_TRUE(propagation.done()) << "nothing new, so nobody follows";
  EXPECT_EQ(ways.map.graph().relations().size(), relations);
}

// Step 5 a.
TEST(Propagation, RefitsTheMapAroundWhatItFound) {
  TwoWays ways;
  EXPECT_GT(ways.error_m(1, 4), 0.15);
  Propagation propagation = ways.begun();
  propagation.enqueue(PatchId{1}, {});
  ASSERT_TRUE(ways.stepped(propagation));
  EXPECT_LT(ways.error_m(1, 4), 0.05);
}

// Step 5 b, until the queue is empty: from one patch to all.
TEST(Propagation, GoesOnToAllThatAreRelatedUntilNothingNewIsFound) {
  TwoWays ways;
  Propagation propagation = ways.begun();
  propagation.enqueue(PatchId{1}, {});
  ways.run(propagation);
  EXPECT_GE(propagation.steps(), 6);
  EXPECT_LE(propagation.steps(), 24) << "a patch comes to the queue four times at most";
  std::set<PatchId> related;
  for (const Relation& relation : induced(ways.map)) related.insert({relation.a, relation.b});
  EXPECT_EQ(related.size(), 6U);
  for (const int patch : {3, 4, 5}) EXPECT_LT(ways.error_m(1, patch), 0.03) << patch;
}

TEST(Propagation, TakesAPatchOnceWhileItWaitsAndNobodyElseWhereNothingNewIsFound) {
  Walls others;
  add_box(others, -6, -6, 7, 5);
  TwoWays ways(crooked_room(), first_drive, others, second_drive);
  Propagation propagation = ways.begun();
  propagation.enqueue(PatchId{1}, {});
  propagation.enqueue(PatchId{1}, {});  // it waits there already
  EXPECT_FALSE(ways.stepped(propagation));
  EXPECT_TRUE(propagation.done());
  EXPECT_TRUE(induced(ways.map).empty());
  EXPECT_TRUE(propagation.matched().empty());
}

TEST(Propagation, TakesPatchesInTurn) {
  TwoWays ways;
  Propagation propagation = ways.begun();
  for (const int patch : {2, 0}) propagation.enqueue(PatchId{patch}, {});
  ways.stepped(propagation);
  ways.stepped(propagation);
  const std::vector<PatchId> in_turn = {PatchId{2}, PatchId{0}};
  EXPECT_EQ(propagation.matched(), in_turn);
}

TEST(Propagation, TakesAPatchFourTimesAndNoMore) {
  Walls others;
  add_box(others, -6, -6, 7, 5);
  TwoWays ways(crooked_room(), first_drive, others, second_drive);
  Propagation propagation = ways.begun();
  for (int i = 0; i < 4; ++i) {
    propagation.enqueue(PatchId{1}, {});
    ASSERT_FALSE(propagation.done());
    ways.stepped(propagation);
  }
  propagation.enqueue(PatchId{1}, {});
  EXPECT_TRUE(propagation.done());
  propagation.forget_visits();
  propagation.enqueue(PatchId{1}, {});
  EXPECT_FALSE(propagation.done());
}

// Patches of other islands lie in other planes, whatever their numbers are.
TEST(Propagation, RelatesNothingToOtherIslands) {
  TwoWays ways;
  Map apart;
  add_way(apart, crooked_room(), first_drive);
  add_way(apart, crooked_room(), second_drive);
  Propagation propagation{apart.graph(), of_closure};
  for (int i = 0; i < 6; ++i) propagation.enqueue(PatchId{i}, {});
  while (!propagation.done()) EXPECT_FALSE(propagation.step(apart, ways.options));
  EXPECT_TRUE(induced(apart).empty());
}

TEST(Propagation, TellsTheSidesOfTheBorderByTheGraphBefore) {
  const TwoWays ways;
  const std::vector<PatchId> first = {PatchId{0}, PatchId{1}, PatchId{2}};
  EXPECT_EQ(ways.begun().same_side(ways.map, PatchId{0}, {}), first);
  const Propagation without(std::nullopt, of_closure);
  EXPECT_EQ(without.same_side(ways.map, PatchId{0}, {}), first)
      << "a sighting says little of where walls are";
}

// Where the border is sharply known, a scan that does not fit what lies there speaks against the change: here
// the second has seen a room that stands askew.
TEST(Propagation, RemembersWhatMustFitAndDoesNot) {
  Walls askew = furnished_room();
  const Pose turn = first_drive[1] * Pose{0, 0, 0.25} * inverse(first_drive[1]);
  for (auto& [from, to] : askew) {
    from = turn * from;
    to = turn * to;
  }
  TwoWays ways(furnished_room(), first_drive, askew, second_drive);
  ways.tell_sharply();
  Propagation propagation = ways.begun();
  propagation.enqueue(PatchId{1}, {});
  EXPECT_FALSE(ways.stepped(propagation));
  EXPECT_EQ(propagation.unmatched(), std::vector<PatchId>{PatchId{1}});
  EXPECT_TRUE(propagation.done());
  propagation.retry({});
  EXPECT_FALSE(propagation.done()) << "once more, when poses are better";
}

// One wall stands where the others saw it, all else is behind their walls: that it does not match says
// nothing.
TEST(Propagation, HoldsNothingAgainstAPatchThatSeesWhatTheOthersDoNot) {
  Walls hall;
  add_box(hall, -9, -9, 9, 3);
  TwoWays ways(hall, first_drive, furnished_room(), second_drive);
  ways.tell_sharply();
  ways.options.surroundings.min_overlap = 0;
  Propagation propagation = ways.begun();
  propagation.enqueue(PatchId{1}, {});
  EXPECT_FALSE(ways.stepped(propagation));
  EXPECT_TRUE(propagation.unmatched().empty());
  EXPECT_TRUE(propagation.done());
  propagation.retry({});
  EXPECT_FALSE(propagation.done()) << "once more, when poses are better";
}

// Whichever of the two was matched: what is left then to compare the other with lies at the edge of its view.
TEST(Propagation, DoesNotHoldAgainstAPatchThatAnotherFoundThatItFindsNoMore) {
  TwoWays ways;
  ways.tell_sharply();
  EngineOptions strict = ways.options;
  strict.common.surprise = ChiSquaredTest(1e-15);
  strict.share_common();  // so that nothing is near enough to where it should be
  Propagation propagation = ways.begun();
  propagation.enqueue(PatchId{1}, {});
  EXPECT_FALSE(propagation.step(ways.map, strict));
  ASSERT_EQ(propagation.unmatched(), std::vector<PatchId>{PatchId{1}});
  propagation.enqueue(PatchId{4}, {});
  ASSERT_TRUE(ways.stepped(propagation));
  ASSERT_FALSE(ways.map.graph().between(PatchId{1}, PatchId{4}).empty());
  EXPECT_TRUE(propagation.unmatched().empty());
  Propagation again = ways.begun();
  again.enqueue(PatchId{1}, {});
  EXPECT_FALSE(again.step(ways.map, strict));
  EXPECT_TRUE(again.unmatched().empty());
}

// Two robots drove through a hall side by side, and each turned at every metre by half a degree more than it
// knew: the ways on their maps bend apart.
std::vector<Pose> along_the_hall(double y) {
  std::vector<Pose> poses;
  for (int i = 0; i < 16; ++i) poses.push_back({1.0 * i, y, 0});
  return poses;
}

// "A single subsequent mutual observation will collapse the entirety of both spirals."
TEST(Propagation, OfOneRelationJoinsTwoWaysAllAlong) {
  EngineOptions options;
  Map map;
  for (const double sign : {-1.0, 1.0}) {
    Pose map_from_patch{0, 0.3 * sign, 0};
    PatchId before;
    for (const Pose& world_from_patch : along_the_hall(0.3 * sign)) {
      const PatchId id = map.manifold().next_id();
      map.add(patch_from(niched_hall(), id, world_from_patch), map_from_patch);
      if (before.valid()) map.relate(odometry_relation(before, id, {1, 0, 0.009 * sign}, {1e3, 1e3, 4e3}));
      map_from_patch = map_from_patch * Pose{1, 0, 0.009 * sign};
      before = id;
    }
  }
  const RelationGraph graph = map.graph();
  map.relate(sighting_relation(PatchId{0}, PatchId{16}, {0, 0.6, 0}));
  const auto apart_m = [&] {
    const Pose r = map.relative_pose(PatchId{15}, PatchId{31});
    return std::hypot(r.x - 0, r.y - 0.6);
  };
  EXPECT_GT(apart_m(), 1.5);
  Propagation propagation{graph, of_closure};
  propagation.enqueue(PatchId{0}, {});
  propagation.enqueue(PatchId{16}, {});
  while (!propagation.done()) propagation.step(map, options);
  EXPECT_LT(apart_m(), 0.1);
  EXPECT_GE(propagation.matched().size(), 16U);
}

}  // namespace
}  // namespace isthmus
