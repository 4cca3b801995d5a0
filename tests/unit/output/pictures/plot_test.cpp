#include "server/output/pictures/plot.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace isthmus {
namespace {

const PixelBox box = {20, 20, 620, 260};

/// How many pixels of a colour are in a box.
int count(const Canvas& canvas, const PixelBox& where, Rgb colour) {
  int found = 0;
  for (int row = static_cast<int>(where.top); row < static_cast<int>(where.bottom); ++row)
    for (int column = static_cast<int>(where.left); column < static_cast<int>(where.right); ++column)
      found += canvas.pixel(column, row) == colour ? 1 : 0;
  return found;
}

TEST(Plot, EverythingIsInsideItsBox) {
  Canvas canvas(640, 280);
  draw_plot(canvas, box, 14, {"seconds", "m"},
            {{way_style(0), {{0, 0}, {1000, 0.3}, {2000, 0.1}}}, {way_style(1), {{500, 0.2}}, false}});
  EXPECT_GT(count(canvas, box, way_style(0).colour), 100);
  EXPECT_GT(count(canvas, box, way_style(1).colour), 3);
  int drawn_outside = 0;
  for (int row = 0; row < canvas.height(); ++row)
    for (int column = 0; column < canvas.width(); ++column)
      drawn_outside += !box.contains({column + 0.5, row + 0.5}) && !(canvas.pixel(column, row) == ink::paper);
  EXPECT_EQ(drawn_outside, 0);
}

TEST(Plot, LargerValuesAreHigherAndAGapStaysOpen) {
  Canvas canvas(640, 280);
  const double gap = std::nan("");
  draw_plot(canvas, box, 14, {"s", "m"},
            {{way_style(0), {{0, 0.2}, {40, 0.2}, {gap, gap}, {60, 0.9}, {100, 0.9}}}});
  const PixelBox left = {20, 20, 300, 260}, right = {400, 20, 620, 260}, middle = {340, 20, 360, 260};
  const auto highest = [&](const PixelBox& where) {
    for (int row = static_cast<int>(where.top); row < static_cast<int>(where.bottom); ++row)
      if (count(canvas, {where.left, static_cast<double>(row), where.right, row + 1.0}, way_style(0).colour) >
          0)
        return row;
    return 1000;
  };
  EXPECT_LT(highest(right), highest(left) - 50);
  EXPECT_EQ(count(canvas, middle, way_style(0).colour), 0);
}

TEST(Plot, MarkersOfSeriesDifferInShape) {
  std::vector<std::string> drawn;
  for (std::size_t marker = 0; marker < plot_markers; ++marker) {
    Canvas canvas(640, 280);
    draw_plot(canvas, box, 14, {"s", "m"}, {{way_style(0), {{0, 1}, {5, 0.5}}, false, marker}});
    EXPECT_GT(count(canvas, box, way_style(0).colour), 3) << marker;
    for (const std::string& other : drawn) EXPECT_NE(canvas.png(), other) << marker;
    drawn.push_back(canvas.png());
  }
}

TEST(Plot, NothingToShowAndOneValueAreShownToo) {
  for (const std::vector<Eigen::Vector2d>& points :
       {std::vector<Eigen::Vector2d>{}, {{5, 0}}, {{5, 0}, {5, 0}}, {{std::nan(""), 1}}}) {
    Canvas canvas(640, 280);
    draw_plot(canvas, box, 14, {"s", "m"}, {{way_style(0), points}});
    EXPECT_EQ(canvas.png().substr(1, 3), "PNG");
  }
  Canvas canvas(640, 280);
  draw_plot(canvas, {20, 20, 60, 40}, 14, {"s", "m"}, {});  // no room
  EXPECT_EQ(canvas.png().substr(1, 3), "PNG");
}

}  // namespace
}  // namespace isthmus
