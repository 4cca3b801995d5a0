#include "server/engine/propagation/layers_job.hpp"

#include <gtest/gtest.h>

#include "tests/support/driven_twice.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

constexpr Pose lies_on_top{};
constexpr Pose lies_aside{9, -9, 1.57};

LayersJob job(const Map& before, const Map& after) {
  return {after,          PatchId{0},
          before.graph(), {before.manifold().poses().begin(), before.manifold().poses().end()},
          1'000'000,      {}};
}

TEST(LayersJob, CountsPairsThatContradictOneAnotherBeforeAndAfter) {
  const Map wrong = map_of_hall_driven_twice(lies_aside), right = map_of_hall_driven_twice(lies_on_top);
  const LayersJob mended = job(wrong, right);
  EXPECT_GE(mended.pairs().before, 10);
  EXPECT_EQ(mended.pairs().after, 0);
  const LayersJob broken = job(right, wrong);
  EXPECT_EQ(broken.pairs().before, 0);
  EXPECT_EQ(broken.pairs().after, mended.pairs().before);
}

TEST(LayersJob, IsDueAfterAsLongAsAFitOfTheIsland) {
  const Map map = map_of_hall_driven_twice(lies_on_top);
  const LayersJob begun = job(map, map);
  const std::int64_t due = 1'000'000 + 24 * MapFitOptions{}.us_per_patch;
  EXPECT_FALSE(begun.is_due(due - 1));
  EXPECT_TRUE(begun.is_due(due));
}

}  // namespace
}  // namespace isthmus
