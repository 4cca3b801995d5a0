#include "relations/weakest_cut.hpp"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

UncertainLink link(int relation, int a, int b, double log_odds, bool of_placing = false) {
  return {RelationId{relation}, PatchId{a}, PatchId{b}, log_odds, of_placing};
}

std::optional<WeakestCut> cut(const std::vector<UncertainLink>& links, int from, int to) {
  const PatchId first{from}, last{to};
  return weakest_cut(links, std::span(&first, 1), std::span(&last, 1));
}

//     0 ==5== 1 ==3== 2 ==5== 3
TEST(WeakestCut, PartsAChainAtItsLeastSureLink) {
  const auto found = cut({link(0, 0, 1, 5), link(1, 1, 2, 3), link(2, 2, 3, 5)}, 0, 3);
  ASSERT_TRUE(found);
  EXPECT_DOUBLE_EQ(found->log_odds, 3);
  EXPECT_EQ(found->relations, std::vector{RelationId{1}});
  EXPECT_EQ(found->beyond, (std::vector{PatchId{2}, PatchId{3}}));
}

// Two ways round: both have to be wrong.
TEST(WeakestCut, AddsUpWhatHasToBeWrongTogether) {
  const auto found = cut({link(0, 0, 1, 2), link(1, 1, 3, 9), link(2, 0, 2, 9), link(3, 2, 3, 4)}, 0, 3);
  ASSERT_TRUE(found);
  EXPECT_DOUBLE_EQ(found->log_odds, 6);
  EXPECT_EQ(found->relations, (std::vector{RelationId{0}, RelationId{3}}));
}

// Patch 3 was placed by 0, 1 and 2 at once: one mistake, where three matches of later would be three.
TEST(WeakestCut, TakesAllThatAPlacingLeftForOneMistake) {
  for (const bool of_placing : {true, false}) {
    std::vector<UncertainLink> links;
    for (int i = 0; i < 3; ++i) {
      if (i > 0) links.push_back(link(10 + i, i - 1, i, 50));
      links.push_back(link(i, i, 3, 8, of_placing));
    }
    const auto found = cut(links, 0, 3);
    ASSERT_TRUE(found);
    EXPECT_DOUBLE_EQ(found->log_odds, of_placing ? 8 : 24);
    EXPECT_EQ(found->relations, (std::vector{RelationId{0}, RelationId{1}, RelationId{2}}));
  }
}

TEST(WeakestCut, IsNoneWhereNothingConnectsTheTwoOrTheyAreOne) {
  EXPECT_FALSE(cut({link(0, 0, 1, 5), link(1, 2, 3, 5)}, 0, 3));
  EXPECT_FALSE(cut({link(0, 0, 1, 5)}, 1, 1));
  EXPECT_FALSE(cut({link(0, 0, 1, 5)}, 0, 7)) << "a patch without a link";
  EXPECT_FALSE(weakest_cut({}, {}, {}));
}

}  // namespace
}  // namespace isthmus
