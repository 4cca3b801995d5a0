#include "server/engine/record/self_check.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/driven_twice.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

constexpr Pose on_top{};
constexpr Pose turned_aside{9, -9, 1.57};

TEST(SelfCheck, FindsNothingWhereAPlaceIsOnTheMapOnce) {
  EXPECT_TRUE(self_contradictions(hall_driven_twice(on_top)).empty());
}

TEST(SelfCheck, FindsAPlaceThatIsOnTheMapTwice) {
  const std::vector<SelfContradiction> found = self_contradictions(hall_driven_twice(turned_aside, "R2"));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].island, PatchId{0});
  EXPECT_GE(found[0].pairs, 10);
  EXPECT_EQ(found[0].robots, (std::vector<std::string>{"R1", "R2"}));
  EXPECT_TRUE(std::ranges::is_sorted(found[0].patches));
  EXPECT_NEAR(found[0].centre_m.x(), 9, 2);
  EXPECT_NEAR(found[0].centre_m.y(), 0, 2);
}

TEST(SelfCheck, ComparesPatchesOfOneIslandOnly) {
  MapCopy map = hall_driven_twice(turned_aside);
  std::vector<RelationId> ties;
  for (const auto& [id, relation] : map.graph.relations())
    if (relation.a == PatchId{11} && relation.b == PatchId{23}) ties.push_back(id);
  map.graph.remove(ties);
  EXPECT_TRUE(self_contradictions(map).empty());
}

TEST(SelfCheck, LeavesWhatFewPairsSayAlone) {
  const MapCopy map = hall_driven_twice(turned_aside);
  SelfCheckOptions options;
  options.min_pairs = 1;
  SelfCheck all(options);
  all.look_at(map, map.patches.size());
  ASSERT_FALSE(all.found(map).empty());
  options.min_pairs = all.found(map)[0].pairs + 1;
  SelfCheck none(options);
  none.look_at(map, map.patches.size());
  EXPECT_TRUE(none.found(map).empty());
}

// So that a status costs the same however large the map is.
TEST(SelfCheck, LooksAtThePatchesInTurn) {
  const MapCopy map = hall_driven_twice(turned_aside);
  SelfCheck check;
  check.look_at(map, 1);
  EXPECT_TRUE(check.found(map).empty()) << "of one patch";
  for (std::size_t i = 1; i < map.patches.size(); ++i) check.look_at(map, 1);
  EXPECT_EQ(check.found(map).at(0).pairs, self_contradictions(map).at(0).pairs);
}

TEST(SelfCheck, TakesBackWhatHasComeRight) {
  SelfCheck check;
  check.look_at(hall_driven_twice(turned_aside), 24);
  const MapCopy mended = hall_driven_twice(on_top);
  check.look_at(mended, mended.patches.size());
  EXPECT_TRUE(check.found(mended).empty());
}

}  // namespace
}  // namespace isthmus
