#include "server/engine/propagation/proximity_matching.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// There and back through a room by odometry alone, and good odometry: 0 and 5 lie side by side, five
// relations from one another, and nothing says so.
//
//     0 --- 1 --- 2
//                 |
//     5 --- 4 --- 3
struct ThereAndBack {
  ThereAndBack() {
    add_way(map, furnished_room(),
            {{-2, -1, 0}, {-1, -1, 0}, {0, -1, 0}, {0, -0.8, 0}, {-1, -0.8, 0}, {-2, -0.8, 0}});
  }
  void advance(std::int64_t now_utime) { proximity_matching.advance(map, options, now_utime); }
  std::size_t relations(int a, int b) const { return map.graph().between(PatchId{a}, PatchId{b}).size(); }

  EngineOptions options;
  Map map;
  ProximityMatching proximity_matching;
};

TEST(ProximityMatching, RelatesWhereARobotStandsToWhatLiesThere) {
  ThereAndBack room;
  EXPECT_FALSE(room.proximity_matching.busy());
  room.proximity_matching.stands_on("R1", PatchId{5}, {});
  EXPECT_TRUE(room.proximity_matching.busy());
  room.advance(1'000'000);
  EXPECT_EQ(room.relations(0, 5), 1U);
  for (const RelationId id : room.map.graph().between(PatchId{0}, PatchId{5}))
    EXPECT_EQ(room.map.graph().find(id)->origin, (Origin{OriginKind::match, {}}));
}

// One step of 5 ms for every 10 ms that pass, and none saved up.
TEST(ProximityMatching, WorksOnHalfOfTheTimeThatPasses) {
  ThereAndBack room;
  room.proximity_matching.match_all(room.map, {});
  const auto all = [&] { return room.map.graph().relations().size(); };
  const std::size_t before = all();
  room.advance(9'999);
  EXPECT_EQ(all(), before);
  room.advance(10'001);
  const std::size_t after_one = all();
  EXPECT_GT(after_one, before);
  room.advance(19'990);
  EXPECT_EQ(all(), after_one);
}

TEST(ProximityMatching, TakesAPatchOnceWhileTheRobotStandsThere) {
  ThereAndBack room;
  room.proximity_matching.stands_on("R1", PatchId{1}, {});
  while (room.proximity_matching.finish_step(room.map, room.options)) {
  }
  room.proximity_matching.stands_on("R1", PatchId{1}, {});
  EXPECT_FALSE(room.proximity_matching.busy());
  room.proximity_matching.stands_on("R2", PatchId{1}, {});
  EXPECT_TRUE(room.proximity_matching.busy()) << "another robot has come";
}

TEST(ProximityMatching, OfAllTakesEveryPatch) {
  ThereAndBack room;
  room.proximity_matching.match_all(room.map, {});
  while (room.proximity_matching.finish_step(room.map, room.options)) {
  }
  EXPECT_FALSE(room.proximity_matching.busy());
  EXPECT_EQ(room.relations(0, 5), 1U);
  EXPECT_EQ(room.relations(1, 2), 1U) << "so near in the graph, the odometry is all there was and is";
}

// Where eq. 12 does not hold, what lies together in the map need not in truth: there a trial decides.
TEST(ProximityMatching, LeavesAloneWhatIsNotWellDetermined) {
  for (const double sigma_rad : {0.01, 0.05}) {
    Map map;
    for (int i = 0; i < 6; ++i) {
      const Pose world_from_patch{0.05 * i, 0, 0};
      map.add(patch_from(furnished_room(), PatchId{i}, world_from_patch), world_from_patch);
      if (i > 0)
        map.relate(odometry_relation(PatchId{i - 1}, PatchId{i}, {0.05, 0, 0},
                                     {1e4, 1e4, 1 / (sigma_rad * sigma_rad)}));
    }
    ProximityMatching proximity_matching;
    proximity_matching.stands_on("R1", PatchId{5}, {});
    proximity_matching.finish_step(map, {});
    const bool well_determined = 1.96 * sigma_rad * std::sqrt(5) < 0.2;
    EXPECT_EQ(map.graph().between(PatchId{0}, PatchId{5}).empty(), !well_determined);
  }
}

}  // namespace
}  // namespace isthmus
