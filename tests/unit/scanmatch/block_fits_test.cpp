#include "scanmatch/block_fits.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace isthmus {
namespace {

// A crooked wall in a box of 5 m by 4 m, as a pyramid has it.
FitPyramid wall_in_a_box(int levels) {
  std::vector<Eigen::Vector2d> wall;
  for (double along = 0; along < 4.8; along += 0.07) wall.emplace_back(along, 1 + 0.3 * along * along / 4);
  return {wall, {0, 0}, {5, 4}, CorrelativeOptions{}, levels};
}

TEST(BlockFits, BoundAllShiftsOfABeamAsThePyramidDoes) {
  constexpr int level = 2, block = 4, shifts = 8;
  const FitPyramid pyramid = wall_in_a_box(level);
  const BlockFits blocks(pyramid, level, shifts);
  int fitting = 0;
  for (const Eigen::Vector2d& end :
       {Eigen::Vector2d(0.3, 0.2), Eigen::Vector2d(0.47, 0.61), Eigen::Vector2d(0.01, 1.3)}) {
    const std::ptrdiff_t cell = pyramid.cell(end);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 5; ++column) {
        const std::uint8_t bound = blocks.data()[blocks.index(cell) + blocks.step(column, row)];
        EXPECT_EQ(bound, pyramid.level(level)[cell + pyramid.step(column * block, row * block)]);
        fitting += bound > 0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(fitting, 10) << "of 45";
}

TEST(BlockFits, HaveNothingToTheRightOfTheMap) {
  constexpr int level = 2, shifts = 8;
  const FitPyramid pyramid = wall_in_a_box(level);
  const BlockFits blocks(pyramid, level, shifts);
  // Far to the left of it the wall begins.
  const std::ptrdiff_t last = blocks.index(pyramid.cell({4.95, 1.05}));
  EXPECT_GT(blocks.data()[blocks.index(pyramid.cell({0.2, 1.05}))], 0);
  for (int column = 2; column <= shifts; ++column) EXPECT_EQ(blocks.data()[last + blocks.step(column, 0)], 0);
}

}  // namespace
}  // namespace isthmus
