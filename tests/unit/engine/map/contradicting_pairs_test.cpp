#include "server/engine/map/contradicting_pairs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/driven_twice.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

TEST(ContradictingPairs, AreMetFromEitherSide) {
  const MapCopy map = hall_driven_twice({9, -9, 1.57});
  const LaidOut laid_out(map.graph, map.patches, map.poses);
  int pairs = 0;
  for (const PatchPtr& patch : map.patches) {
    for (const PatchId other : laid_out.contradicted_by(patch->id, {})) {
      ++pairs;
      EXPECT_EQ(std::ranges::count(laid_out.contradicted_by(other, {}), patch->id), 1);
      EXPECT_TRUE((patch->id < PatchId{12}) != (other < PatchId{12})) << "one drive contradicts the other";
    }
  }
  EXPECT_GE(pairs, 20);
}

TEST(ContradictingPairs, AreNearOneAnotherAndSoManyAtMost) {
  const MapCopy map = hall_driven_twice({9, -9, 1.57});
  const LaidOut laid_out(map.graph, map.patches, map.poses);
  ContradictingPairsOptions options;
  options.max_compared = 1;
  for (const PatchPtr& patch : map.patches) {
    EXPECT_LE(laid_out.contradicted_by(patch->id, options).size(), 1U);
    for (const PatchId other : laid_out.contradicted_by(patch->id, {})) {
      const Pose apart = ominus(map.poses[index(other)], map.poses[index(patch->id)]);
      EXPECT_LT(std::hypot(apart.x, apart.y), options.reach_m);
    }
  }
}

}  // namespace
}  // namespace isthmus
