#include "server/output/pictures/marks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/output/pictures/way_pen.hpp"

namespace isthmus {
namespace {

constexpr double em = 16;

/// 10 m × 8 m of a map at 40 pixels a metre, its lower left corner at the origin.
MapWindow window() { return {{10, 20, 410, 340}, {0, 8}, 40, em}; }
Canvas canvas() { return Canvas(420, 360); }

Rgb at(const Canvas& canvas, const Eigen::Vector2d& map_point) {
  const Eigen::Vector2d pixel = window().pixels(map_point);
  return canvas.pixel(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
}

TEST(MapWindow, YPointsUpOnTheMapAndDownOnThePicture) {
  EXPECT_EQ(window().pixels({0, 0}), Eigen::Vector2d(10, 340));
  EXPECT_EQ(window().pixels({10, 8}), Eigen::Vector2d(410, 20));
  EXPECT_EQ(window().right_bottom_m(), Eigen::Vector2d(10, 0));
}

TEST(WayPen, AWayIsDrawnFromPlaceToPlaceButNotAcrossAJump) {
  Canvas picture = canvas();
  {
    WayPen pen(picture, window(), way_style(0));
    for (double x = 1; x <= 3; x += 0.1) pen.to({x, 4});
    for (double x = 6; x <= 8; x += 0.1) pen.to({x, 4});
  }
  EXPECT_EQ(at(picture, {2.03, 4}), way_style(0).colour);
  EXPECT_EQ(at(picture, {7.03, 4}), way_style(0).colour);
  EXPECT_EQ(at(picture, {4.5, 4}), ink::paper);
}

TEST(WayPen, NothingIsDrawnBesideTheWindow) {
  Canvas picture = canvas();
  {
    WayPen pen(picture, window(), way_style(0));
    for (double x = -0.2; x <= 10.2; x += 0.1) pen.to({x, 4});
  }
  EXPECT_EQ(at(picture, {0.05, 4}), way_style(0).colour);
  EXPECT_EQ(at(picture, {-0.1, 4}), ink::paper);
  EXPECT_EQ(at(picture, {10.1, 4}), ink::paper);
}

/// However many points at once are drawn, dashes run on.
TEST(WayPen, DashesOfALongWayRunOn) {
  const auto share_drawn = [](int laps) {
    Canvas picture = canvas();
    {
      WayPen pen(picture, window(), way_style(1));
      for (int i = 0; i <= 9000 * laps; ++i) {
        const double angle = 2 * std::numbers::pi * i / 9000;
        pen.to({5 + 3 * std::cos(angle), 4 + 3 * std::sin(angle)});
      }
    }
    int drawn = 0;
    for (int i = 0; i < 360; ++i) {
      const double angle = 2 * std::numbers::pi * i / 360;
      drawn += at(picture, {5 + 3 * std::cos(angle), 4 + 3 * std::sin(angle)}) == ink::paper ? 0 : 1;
    }
    return drawn / 360.0;
  };
  EXPECT_NEAR(share_drawn(1), 5.0 / 7, 0.1);
}

TEST(Marks, AnEndPointsToWhereTheRobotLooks) {
  Canvas picture = canvas();
  draw_end(picture, window(), {5, 4, std::numbers::pi / 2}, way_style(0));
  const double tip_m = 0.6 * em / 40;
  EXPECT_LT(at(picture, {5, 4 + tip_m}).red, 60);
  EXPECT_EQ(at(picture, {5, 4 - tip_m}), ink::paper);
}

TEST(Marks, AStartIsARingThatShowsTheHeading) {
  Canvas picture = canvas();
  draw_start(picture, window(), {5, 4, std::numbers::pi}, way_style(2));
  EXPECT_EQ(at(picture, {5, 4}), ink::paper);
  EXPECT_EQ(at(picture, {5 - 0.9 * em / 40, 4}), way_style(2).colour);
  EXPECT_EQ(at(picture, {5 + 0.9 * em / 40, 4}), ink::paper);
}

TEST(Marks, AnEndOnAStartLeavesItToBeSeen) {
  Canvas picture = canvas();
  draw_start(picture, window(), {5, 4, 0}, way_style(2));
  draw_end(picture, window(), {5, 4, 0}, way_style(0));
  EXPECT_EQ(at(picture, {5, 4}), way_style(0).colour);
  for (const double side : {-1.0, 1.0})
    EXPECT_EQ(at(picture, {5, 4 + side * 0.7 * em / 40}), way_style(2).colour);
}

TEST(Marks, ManyClosedLoopsAreFaintAndAFewAreNot) {
  const auto darkest = [](std::size_t loops) {
    Canvas picture = canvas();
    draw_closure(picture, window(), {2, 4}, {8, 4}, loop_style(loops));
    int least = 255;
    for (double x = 2; x <= 8; x += 0.02)
      for (double y = 3; y <= 5; y += 0.02) least = std::min<int>(least, at(picture, {x, y}).red);
    return least;
  };
  EXPECT_EQ(darkest(1), 0);
  EXPECT_EQ(darkest(30), 0);
  EXPECT_GT(darkest(60), 60);
  EXPECT_GT(darkest(85), darkest(60));
  EXPECT_LT(darkest(100'000), 240) << "it is still seen";
}

/// 95 % of a Gaussian of two dimensions is within 2.4477 σ.
TEST(Marks, AnEllipseReachesAsFarAs95Percent) {
  Canvas picture = canvas();
  const Eigen::Matrix2d covariance = Eigen::Vector2d(0.25, 0.04).asDiagonal();
  draw_ellipse(picture, window(), {5, 4}, covariance, 2, {.colour = way_style(0).colour, .width_px = 4});
  EXPECT_EQ(at(picture, {5 + 2 * 2.4477 * 0.5, 4}), way_style(0).colour);
  EXPECT_EQ(at(picture, {5, 4 + 2 * 2.4477 * 0.2}), way_style(0).colour);
  EXPECT_EQ(at(picture, {5, 4}), ink::paper);
}

TEST(Labels, NoneCoversAnotherAndAllAreInsideTheWindow) {
  Canvas picture = canvas();
  Labels labels(window());
  labels.keep_free({5, 4});
  for (int i = 0; i < 8; ++i) labels.draw(picture, "R" + std::to_string(i), {5, 4}, {.size_px = em});
  labels.draw(picture, "CORNER", {9.95, 7.95}, {.size_px = em});
  ASSERT_EQ(labels.taken().size(), 10U);
  for (std::size_t i = 0; i < labels.taken().size(); ++i) {
    const PixelBox& box = labels.taken()[i];
    EXPECT_TRUE(window().box.contains({box.left, box.top}) && window().box.contains({box.right, box.bottom}));
    for (std::size_t j = 0; j < i; ++j) EXPECT_FALSE(box.overlaps(labels.taken()[j])) << i << ", " << j;
  }
}

}  // namespace
}  // namespace isthmus
