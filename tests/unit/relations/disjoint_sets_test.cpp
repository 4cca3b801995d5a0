#include "relations/disjoint_sets.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

namespace isthmus {
namespace {

TEST(DisjointSets, AreNamedByTheirLowestMemberWhateverTheOrderOfJoining) {
  std::vector<std::pair<int, int>> joints = {{7, 9}, {9, 4}, {4, 8}, {1, 5}, {5, 6}, {6, 1}};
  std::mt19937 random(1);
  for (int run = 0; run < 50; ++run) {
    std::shuffle(joints.begin(), joints.end(), random);
    std::vector<int> parents(10);
    std::iota(parents.begin(), parents.end(), 0);
    DisjointSets<int> sets(parents);
    for (const auto& [a, b] : joints) sets.join(a, b);
    std::vector<int> lowest;
    for (int member = 0; member < 10; ++member) lowest.push_back(sets.lowest(member));
    EXPECT_EQ(lowest, (std::vector<int>{0, 1, 2, 3, 4, 1, 1, 4, 4, 4}));
  }
}

TEST(DisjointSets, AskingShortensTheWayAndChangesNoSet) {
  std::vector<PatchId> parents = {PatchId{0}, PatchId{0}, PatchId{1}, PatchId{2}};
  DisjointSets<PatchId> sets(parents);
  EXPECT_EQ(sets.lowest(PatchId{3}), PatchId{0});
  EXPECT_EQ(parents[3], PatchId{1});
  EXPECT_EQ(sets.lowest(PatchId{2}), PatchId{0});
}

}  // namespace
}  // namespace isthmus
