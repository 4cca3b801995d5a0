#include "server/paths/ground/cell_line.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace isthmus {
namespace {

std::vector<Cell> cells(const Cell& from, const Cell& to) {
  std::vector<Cell> found;
  for (CellLine line(from, to); !line.done();) found.push_back(line.step());
  return found;
}

TEST(CellLine, ComesThroughEachCellThatItCrosses) {
  EXPECT_EQ(cells({0, 0}, {3, 1}), (std::vector<Cell>{{1, 0}, {2, 1}, {3, 1}}));
  EXPECT_EQ(cells({0, 0}, {-1, -4}), (std::vector<Cell>{{0, -1}, {0, -2}, {-1, -2}, {-1, -3}, {-1, -4}}));
}

TEST(CellLine, ThroughACornerItGoesStraightToTheCellBeyond) {
  EXPECT_EQ(cells({5, 5}, {7, 3}), (std::vector<Cell>{{6, 4}, {7, 3}}));
}

TEST(CellLine, FromACellToItselfThereIsNoStep) { EXPECT_TRUE(CellLine({2, -3}, {2, -3}).done()); }

TEST(CellLine, ALeapEndsOnTheLineAndNoFartherThanAsked) {
  for (const Cell to : {Cell{40, 13}, Cell{-9, 40}, Cell{-30, -30}, Cell{0, -17}, Cell{25, 24}, Cell{1, 0}}) {
    const std::vector<Cell> all = cells({0, 0}, to);
    for (const std::int32_t length : {1, 2, 3, 7, 100}) {
      CellLine line({0, 0}, to);
      std::size_t next = 0;
      while (!line.done()) {
        const Cell before = line.at(), after = line.leap(length);
        EXPECT_LE(std::max(std::abs(after.x - before.x), std::abs(after.y - before.y)), length);
        while (next < all.size() && all[next] != after) ++next;
        ASSERT_LT(next, all.size()) << "to " << to.x << ", " << to.y << " by " << length;
      }
      EXPECT_EQ(line.at(), to);
    }
  }
}

}  // namespace
}  // namespace isthmus
