#include "server/output/pictures/layout.hpp"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

/// Cells across and up: tiny, a room, a building, a long corridor, a tower, a huge hall.
const std::vector<std::pair<int, int>> map_sizes = {{9, 9},      {400, 300},  {900, 850},    {20000, 60},
                                                    {60, 20000}, {4000, 400}, {10000, 10000}};

SheetParts parts_of(int width_cells, int height_cells, std::size_t legend_entries = 12) {
  const CellScale scale = cell_scale(width_cells, height_cells);
  SheetParts parts;
  parts.map_width = static_cast<double>(width_cells * scale.pixels_per_cell / scale.cells_per_pixel);
  parts.map_height = static_cast<double>(height_cells * scale.pixels_per_cell / scale.cells_per_pixel);
  parts.em = 16;
  parts.title_width = 400;
  parts.tick_width = 40;
  parts.bar_width = parts.map_width / 4 + 50;
  parts.legend_entries = legend_entries;
  parts.legend_width = 180;
  parts.panel_height = 200;
  return parts;
}

std::vector<PixelBox> boxes_of(const SheetLayout& layout) {
  std::vector<PixelBox> boxes = {layout.map,    layout.title, layout.x_axis,
                                 layout.y_axis, layout.bar,   layout.panel};
  boxes.insert(boxes.end(), layout.legend.begin(), layout.legend.end());
  return boxes;
}

TEST(SheetLayout, NothingIsOnTheMapNorOnAnythingElse) {
  for (const auto& [width, height] : map_sizes)
    for (const std::size_t legend : {0U, 1U, 12U, 50U}) {
      const std::vector<PixelBox> boxes = boxes_of(lay_out(parts_of(width, height, legend)));
      for (std::size_t i = 0; i < boxes.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
          EXPECT_FALSE(boxes[i].overlaps(boxes[j])) << width << 'x' << height << ": " << i << ", " << j;
    }
}

TEST(SheetLayout, EverythingIsOnTheSheet) {
  for (const auto& [width, height] : map_sizes)
    for (const std::size_t legend : {0U, 1U, 12U, 50U}) {
      const SheetLayout layout = lay_out(parts_of(width, height, legend));
      EXPECT_EQ(layout.legend.size(), legend);
      for (const PixelBox& box : boxes_of(layout)) {
        EXPECT_GE(box.left, 0);
        EXPECT_GE(box.top, 0);
        EXPECT_LE(box.right, layout.width);
        EXPECT_LE(box.bottom, layout.height);
      }
    }
}

TEST(SheetLayout, TheLegendOfALongLowMapIsBelowItAndOthersBeside) {
  EXPECT_GT(lay_out(parts_of(4000, 100)).legend.front().top, lay_out(parts_of(4000, 100)).bar.bottom);
  EXPECT_GT(lay_out(parts_of(900, 850)).legend.front().left, lay_out(parts_of(900, 850)).map.right);
}

TEST(CellScale, MapsOfAnySizeFillAScreenAndNoMore) {
  for (const auto& [width, height] : map_sizes) {
    const CellScale scale = cell_scale(width, height);
    EXPECT_TRUE(scale.pixels_per_cell == 1 || scale.cells_per_pixel == 1);
    const double longer = std::max(width, height) * scale.pixels_per_cell / scale.cells_per_pixel;
    EXPECT_LE(longer, std::max(width, height) > 4 * std::min(width, height) ? 4800 : 2400);
    if (std::max(width, height) > 300) {
      EXPECT_GE(longer, 900);
    }
  }
  EXPECT_EQ(cell_scale(9, 9).pixels_per_cell, 6);
  EXPECT_DOUBLE_EQ(cell_scale(9, 9).pixels_per_m(0.05), 120);
  EXPECT_DOUBLE_EQ(cell_scale(10000, 10000).pixels_per_m(0.05), 4);
}

TEST(RoundLength, IsOneTwoOrFiveTimesAPowerOfTen) {
  EXPECT_DOUBLE_EQ(round_length(4.99), 2);
  EXPECT_DOUBLE_EQ(round_length(5), 5);
  EXPECT_DOUBLE_EQ(round_length(0.19), 0.1);
  EXPECT_DOUBLE_EQ(round_length(1234), 1000);
  EXPECT_DOUBLE_EQ(round_length_above(5.01), 10);
  EXPECT_DOUBLE_EQ(round_length_above(5), 5);
  EXPECT_DOUBLE_EQ(round_length_above(0.11), 0.2);
}

TEST(Ticks, AreTheWholeMultiplesInBetween) {
  EXPECT_EQ(ticks(-0.9, 1.1, 0.5).size(), 4U);  // -.5, 0, .5, 1
  EXPECT_DOUBLE_EQ(ticks(-0.9, 1.1, 0.5).front(), -0.5);
  EXPECT_EQ(tick_text(-0.5, 0.5), "-0.5");
  EXPECT_EQ(tick_text(20, 10), "20");
  EXPECT_EQ(tick_text(0.25, 0.05), "0.25");
}

}  // namespace
}  // namespace isthmus
