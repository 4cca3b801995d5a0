#include "scanmatch/correlative.hpp"

#include <gtest/gtest.h>

#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

LocalMap view_of(const Walls& walls, const Pose& from) {
  return {PatchId{0}, {{patch_from(walls, PatchId{0}, from), from}}};
}

TEST(SearchWindow, FindsAPoseFarFromTheCentreToWithinACell) {
  const Pose truth{0.9, -0.6, 0.35};
  const auto points = to_points(scan_from(furnished_room(), truth), laser_of(), {});
  const CorrelativeResult found =
      search_window(view_of(furnished_room(), {0, 0, 0.1}), points, {{0, 0, 0}, 1.5, 1.5, 0.6}, {});
  EXPECT_NEAR(found.local_from_robot.x, truth.x, 0.12);
  EXPECT_NEAR(found.local_from_robot.y, truth.y, 0.12);
  EXPECT_NEAR(found.local_from_robot.yaw, truth.yaw, 0.03);
  EXPECT_GT(found.score, 0.6);
  EXPECT_FALSE(found.exhausted);
}

// As far as the walls are seen from both: where a view of one ends, the end tells.
TEST(SearchWindow, ACorridorHasASecondAnswerAsGoodAsTheFirst) {
  const auto points = to_points(scan_from(corridor(), {0.3, 0, 0}), laser_of(), {});
  CorrelativeOptions near;
  near.reach_m = 12;
  const CorrelativeResult found =
      search_window(view_of(corridor(), {0, 0, 0}), points, {{0, 0, 0}, 2, 0.5, 0.3}, near);
  EXPECT_GT(found.second_score, 0.9 * found.score);
}

// On a wide street nothing else is near enough.
TEST(SearchWindow, TakesWallsThatStandThirteenMetresAway) {
  Walls street;
  add_box(street, -30, -13, 16, 13);
  const Pose truth{0.4, -0.2, 0.05};
  const auto points = to_points(scan_from(street, truth), laser_of(), {});
  const CorrelativeResult found =
      search_window(view_of(street, {0, 0, 0}), points, {{0, 0, 0}, 1, 1, 0.2}, {});
  EXPECT_GT(found.score, 0.5);
  EXPECT_NEAR(found.local_from_robot.x, truth.x, 0.11);
  EXPECT_NEAR(found.local_from_robot.y, truth.y, 0.11);
}

TEST(SearchWindow, AFurnishedRoomHasNoSecondAnswer) {
  const auto points = to_points(scan_from(furnished_room(), {0.3, 0, 0.1}), laser_of(), {});
  const CorrelativeResult found =
      search_window(view_of(furnished_room(), {0, 0, 0}), points, {{0, 0, 0}, 1, 1, 0.4}, {});
  EXPECT_LT(found.second_score, 0.9 * found.score);
}

TEST(SearchWindow, WorkIsCappedAndSaysSo) {
  const auto points = to_points(scan_from(corridor(), {}), laser_of(), {});
  CorrelativeOptions options;
  options.max_evaluations = 50;
  EXPECT_TRUE(search_window(view_of(corridor(), {}), points, {{0, 0, 0}, 3, 3, 1}, options).exhausted);
}

TEST(SearchWindow, NoPointsGiveTheCentreAndNoScore) {
  const CorrelativeResult found = search_window(view_of(corridor(), {}), {}, {{1, 2, 0.5}, 1, 1, 1}, {});
  EXPECT_EQ(found.score, 0);
  EXPECT_EQ(found.local_from_robot, (Pose{1, 2, 0.5}));
}

// Window and reach make a grid of 4.9 m; the coarsest blocks of shifts begin half a cell left of it, and what
// fits lies in its first column.
TEST(SearchWindow, FindsWhatLiesAtTheEdgeOfItsGrid) {
  CorrelativeOptions options;
  options.reach_m = 2;
  for (const double side : {-1, 1}) {
    for (const bool along_x : {true, false}) {
      std::vector<ScanPoint> points;
      std::vector<Eigen::Vector2d> map;
      for (const double across : {-0.3, 0.0, 0.45}) {
        const double far = side * std::sqrt(3.999 - across * across);
        const Eigen::Vector2d end = along_x ? Eigen::Vector2d(far, across) : Eigen::Vector2d(across, far);
        points.push_back({end, Eigen::Vector2d::Zero()});
        map.push_back(end + side * 0.4 * (along_x ? Eigen::Vector2d::UnitX() : Eigen::Vector2d::UnitY()));
      }
      const SearchWindow window{{}, 0.45, 0.45, 0};
      const CorrelativeResult found = search_window(map, points, window, options);
      EXPECT_NEAR(found.local_from_robot.x, along_x ? side * 0.4 : 0, 1e-9);
      EXPECT_NEAR(found.local_from_robot.y, along_x ? 0 : side * 0.4, 1e-9);
      EXPECT_GT(found.score, 0.8);
    }
  }
}
}  // namespace
}  // namespace isthmus
