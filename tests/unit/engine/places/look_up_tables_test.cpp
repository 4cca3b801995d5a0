#include "server/engine/places/look_up_tables.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// Each job looks up on a copy of the map, which ends with it.
TEST(LookUpTables, OutliveTheMapThatTheyAreOf) {
  Map map;
  add_way(map, furnished_room(), {{-2, -1, 0}, {-1, -1, 0}, {0, -1, 0}, {1, -1, 0}}, Pose{});
  LookUpTables tables;
  const std::vector<PatchId> others = {PatchId{0}, PatchId{3}};
  const auto of_map = [&] {
    const auto copy = std::make_unique<Map>(map);
    return tables.covariances(*copy, PatchId{0}).relative_to(PatchId{1}, others);
  };
  const std::vector<Eigen::Matrix3d> first = of_map(), again = of_map();
  ASSERT_EQ(first.size(), 2U);
  EXPECT_EQ(first, again);
}

TEST(KeptTables, AreThoseOfTheMapUntilItChanges) {
  Map map;
  add_way(map, furnished_room(), {{-2, -1, 0}, {-1, -1, 0}, {0, -1, 0}, {1, -1, 0}, {2, -1, 0}, {2, 0, 2}},
          Pose{});
  KeptTables kept;
  const std::shared_ptr<LookUpTables> tables = kept.of(map);
  const PatchId first{0}, last{5};
  EXPECT_EQ(tables->network(map).ways_m(std::span(&first, 1)),
            ways_over_relations_m(map, std::span(&first, 1)));
  EXPECT_EQ(&tables->covariances(map, first), &tables->covariances(map, first)) << "once an island";
  const Map copy = map;
  EXPECT_EQ(kept.of(copy), tables) << "a copy is the same map";

  map.relate(odometry_relation(first, last, map.relative_pose(first, last), {100, 100, 100}));
  const std::shared_ptr<LookUpTables> anew = kept.of(map);
  EXPECT_NE(anew, tables);
  EXPECT_EQ(anew->network(map).ways_m(std::span(&first, 1)),
            ways_over_relations_m(map, std::span(&first, 1)));
}

}  // namespace
}  // namespace isthmus
