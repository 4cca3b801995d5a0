#include "server/output/pictures/map_sheet.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "server/output/pictures/shade.hpp"

namespace isthmus {
namespace {

OccupancyGrid grid_of(int width, int height, std::uint8_t cell = OccupancyGrid::free) {
  OccupancyGrid grid;
  grid.origin_x_m = -3.4;
  grid.origin_y_m = 1.2;
  grid.width = width;
  grid.height = height;
  grid.pixels.assign(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), cell);
  return grid;
}

MapSheet sheet_of(const OccupancyGrid& grid) {
  return MapSheet(grid, {"Island 0", "2 robots"},
                  {way_entry("R1", way_style(0)), way_entry("R2", way_style(1)), note_entry("and 3 more")});
}

const std::vector<std::pair<int, int>> grid_sizes = {
    {9, 9}, {300, 200}, {2000, 40}, {40, 2000}, {3000, 2900}};

TEST(MapSheet, TheScaleBarIsAsLongAsItsMetresAre) {
  for (const auto& [width, height] : grid_sizes) {
    MapSheet sheet = sheet_of(grid_of(width, height));
    const PixelBox& bar = sheet.layout().bar;
    const int row = static_cast<int>(std::floor((bar.top + bar.bottom) / 2));
    int column = static_cast<int>(bar.left), length = 0;
    while (sheet.canvas().pixel(column, row) == ink::text) ++column, ++length;
    EXPECT_NEAR(length, sheet.scale_bar_m() * sheet.window().pixels_per_m, 1) << width << 'x' << height;
    EXPECT_LE(length, width * 0.05 * sheet.window().pixels_per_m / 4 + 1);
  }
}

TEST(MapSheet, NothingIsDrawnOnTheMap) {
  for (const auto& [width, height] : grid_sizes) {
    MapSheet sheet = sheet_of(grid_of(width, height));
    const PixelBox& map = sheet.layout().map;
    std::size_t others = 0;
    for (int row = static_cast<int>(map.top); row < static_cast<int>(map.bottom); ++row)
      for (int column = static_cast<int>(map.left); column < static_cast<int>(map.right); ++column)
        others += sheet.canvas().pixel(column, row) == ink::floor ? 0 : 1;
    EXPECT_EQ(others, 0U) << width << 'x' << height;
  }
}

TEST(MapSheet, ThereIsInkInTitleAxesBarAndLegend) {
  MapSheet sheet = sheet_of(grid_of(300, 200));
  const SheetLayout& layout = sheet.layout();
  for (const PixelBox& box : {layout.title, layout.x_axis, layout.y_axis, layout.bar, layout.legend[0],
                              layout.legend[1], layout.legend[2]}) {
    std::size_t drawn = 0;
    for (int row = static_cast<int>(box.top); row < static_cast<int>(box.bottom); ++row)
      for (int column = static_cast<int>(box.left); column < static_cast<int>(box.right); ++column)
        drawn += sheet.canvas().pixel(column, row) == ink::paper ? 0 : 1;
    EXPECT_GT(drawn, 20U);
  }
}

TEST(MapSheet, APointOfTheMapIsDrawnWhereItsCellIs) {
  for (const auto& [width, height] : grid_sizes) {
    OccupancyGrid grid = grid_of(width, height);
    const int column = width / 3, row = height / 4;  // from the top
    grid.pixels[static_cast<std::size_t>(row * width + column)] = OccupancyGrid::occupied;
    MapSheet sheet = sheet_of(grid);
    const Eigen::Vector2d centre(grid.origin_x_m + (column + 0.5) * grid.resolution_m,
                                 grid.origin_y_m + (height - row - 0.5) * grid.resolution_m);
    const Eigen::Vector2d at = sheet.window().pixels(centre);
    const Rgb shown = sheet.canvas().pixel(static_cast<int>(at.x()), static_cast<int>(at.y()));
    EXPECT_LT(shown.red, ink::floor.red - 80) << width << 'x' << height;
  }
}

/// Tags beside the grid, and some at its very edge.
TEST(MapSheet, HoldsMarksBesideTheGridInWhole) {
  for (const auto& [width, height] : grid_sizes) {
    const OccupancyGrid grid = grid_of(width, height);
    const Eigen::Vector2d low(grid.origin_x_m - 1.3, grid.origin_y_m);
    const Eigen::Vector2d high(grid.origin_x_m + width * grid.resolution_m,
                               grid.origin_y_m + height * grid.resolution_m + 2.7);
    MapSheet sheet(grid, {"Island 0", "2 robots"}, {}, 0, {low, high});
    const MapWindow& window = sheet.window();
    const double reach = 1.5 * window.em;
    for (const Eigen::Vector2d& point : {low, high}) {
      const Eigen::Vector2d at = window.pixels(point);
      EXPECT_TRUE(window.box.contains(at.array() - reach) && window.box.contains(at.array() + reach))
          << width << 'x' << height;
    }
    const Eigen::Vector2d corner = window.pixels({grid.origin_x_m, grid.origin_y_m});
    const int column = static_cast<int>(std::round(corner.x())), row = static_cast<int>(corner.y()) - 2;
    EXPECT_EQ(sheet.canvas().pixel(column, row), ink::floor) << width << 'x' << height;
    EXPECT_EQ(sheet.canvas().pixel(column - 1, row), ink::unknown) << width << 'x' << height;
  }
}

TEST(MapFrame, IsTheGridWhereNothingIsBesideIt) {
  const OccupancyGrid grid = grid_of(300, 200);
  for (const MapBox& held : {MapBox{}, MapBox{{0, 5}, {5, 8}}}) {
    const MapFrame frame = map_frame(grid, held);
    EXPECT_EQ(frame.width, 300);
    EXPECT_EQ(frame.height, 200);
    EXPECT_EQ(frame.left_top_m, Eigen::Vector2d(-3.4, 11.2));
  }
}

TEST(MapFrame, IsBoundedWhereverAPointIs) {
  for (const double far : {1e3, 1e9, 1e300}) {
    const MapFrame frame = map_frame(grid_of(300, 200), {{-far, -far}, {far, far}});
    EXPECT_LE(frame.width, 300 + 2 * 600 + 2);
    EXPECT_LE(frame.width_px(), 2402);
  }
}

TEST(MapSheet, AnyNameIsDrawn) {
  for (const std::string& name : {std::string("\xff\xfe R\x01\xc3"), std::string("R\xc3\xbc\x62"),
                                  std::string("\xf0\x9f\xa4\x96"), std::string("\xed\xa0\x80")}) {
    MapSheet sheet(grid_of(30, 20), {name, name}, {way_entry(name, way_style(0))});
    EXPECT_EQ(sheet.canvas().png().substr(1, 3), "PNG");
  }
}

TEST(MapSheet, TheSameMapIsTheSamePicture) {
  EXPECT_EQ(sheet_of(grid_of(300, 200)).canvas().png(), sheet_of(grid_of(300, 200)).canvas().png());
}

TEST(Shade, AWallOfOneCellStaysDarkHoweverSmallItIsShown) {
  OccupancyGrid grid = grid_of(100, 100);
  for (int i = 0; i < 100; ++i) grid.pixels[static_cast<std::size_t>(i * 100 + 37)] = OccupancyGrid::occupied;
  const Image image = shade(grid, 10);
  ASSERT_EQ(image.pixels.size(), 100U);
  EXPECT_EQ(image.pixels[3], ink::wall);
  EXPECT_EQ(image.pixels[2], ink::floor);
}

TEST(Shade, CellsBeyondTheEdgeCountForNothing) {
  const Image image = shade(grid_of(15, 5), 10);
  ASSERT_EQ(image.width, 2);
  ASSERT_EQ(image.height, 1);
  EXPECT_EQ(image.pixels[1], ink::floor);
  EXPECT_EQ(shade(grid_of(4, 4, OccupancyGrid::unknown), 3).pixels[0], ink::unknown);
}

}  // namespace
}  // namespace isthmus
