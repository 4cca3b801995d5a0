#include "server/paths/roads/point_graph.hpp"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

/// A square of 10 m with a point on one side: 0 - 1 - 2 - 3 - 0, and 4 that is beside none.
PointGraph ring() {
  return {{{0, 0}, {10, 0}, {10, 10}, {0, 10}, {5, 5}},
          {{0, 1}, {1, 0}, {1, 2}, {2, 1}, {2, 3}, {3, 2}, {3, 0}, {0, 3}, {0, 1}}};
}

TEST(PointGraph, NeighboursAreThereOnce) {
  const PointGraph graph = ring();
  EXPECT_EQ(std::vector<std::int32_t>(graph.beside(0).begin(), graph.beside(0).end()),
            (std::vector<std::int32_t>{1, 3}));
  EXPECT_TRUE(graph.beside(4).empty());
}

TEST(PointGraph, LengthsAreThoseOfTheShortestWaysAndInfiniteWhereThereIsNone) {
  const std::vector<float> lengths = ring().lengths_from(0);
  EXPECT_EQ(lengths, (std::vector<float>{0, 10, 20, 10, std::numeric_limits<float>::infinity()}));
}

TEST(PointGraph, ASearchWithAGoalEndsWhereItsReachDoes) {
  const PointGraph line({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {9, 0}, {20, 0}},
                        {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}});
  const std::vector<float> lengths = line.lengths_from(0, {2, 1.5F, 0});
  EXPECT_EQ(lengths[3], 3);
  EXPECT_EQ(lengths[5], std::numeric_limits<float>::infinity());
}

}  // namespace
}  // namespace isthmus
