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
  const auto points = to_points(scan_from(furnished_room(), truth), laser_of());
  const CorrelativeResult found =
      search_window(view_of(furnished_room(), {0, 0, 0.1}), points, {{0, 0, 0}, 1.5, 1.5, 0.6});
  EXPECT_NEAR(found.local_from_robot.x, truth.x, 0.12);
  EXPECT_NEAR(found.local_from_robot.y, truth.y, 0.12);
  EXPECT_NEAR(found.local_from_robot.yaw, truth.yaw, 0.03);
  EXPECT_GT(found.score, 0.6);
  EXPECT_FALSE(found.exhausted);
}

TEST(SearchWindow, ACorridorHasASecondAnswerAsGoodAsTheFirst) {
  const auto points = to_points(scan_from(corridor(), {0.3, 0, 0}), laser_of());
  const CorrelativeResult found =
      search_window(view_of(corridor(), {0, 0, 0}), points, {{0, 0, 0}, 2, 0.5, 0.3});
  EXPECT_GT(found.second_score, 0.9 * found.score);
}

TEST(SearchWindow, AFurnishedRoomHasNoSecondAnswer) {
  const auto points = to_points(scan_from(furnished_room(), {0.3, 0, 0.1}), laser_of());
  const CorrelativeResult found =
      search_window(view_of(furnished_room(), {0, 0, 0}), points, {{0, 0, 0}, 1, 1, 0.4});
  EXPECT_LT(found.second_score, 0.9 * found.score);
}

TEST(SearchWindow, WorkIsCappedAndSaysSo) {
  const auto points = to_points(scan_from(corridor(), {}), laser_of());
  CorrelativeOptions options;
  options.max_evaluations = 50;
  EXPECT_TRUE(search_window(view_of(corridor(), {}), points, {{0, 0, 0}, 3, 3, 1}, options).exhausted);
}

TEST(SearchWindow, NoPointsGiveTheCentreAndNoScore) {
  const CorrelativeResult found = search_window(view_of(corridor(), {}), {}, {{1, 2, 0.5}, 1, 1, 1});
  EXPECT_EQ(found.score, 0);
  EXPECT_EQ(found.local_from_robot, (Pose{1, 2, 0.5}));
}

}  // namespace
}  // namespace isthmus
