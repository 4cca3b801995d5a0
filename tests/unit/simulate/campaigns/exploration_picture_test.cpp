#include "tools/simulate/campaigns/explore/exploration_picture.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "server/output/pictures/marks.hpp"
#include "tests/support/ground_scenes.hpp"

namespace isthmus {
namespace {

/// A robot that drives round a corner of a room, to look from (2, -2): not the straight way.
///
///     R1 (-2, 2) ---->----+ (2, 2)
///                         |
///                         v (2, -2)
class ExplorationPicture : public ::testing::Test {
 protected:
  ExplorationPicture() {
    Map map;
    testing::add_round_way(map, testing::furnished_room(), {{-1, 0, 0}, {1, 0, 0}});
    planner_.update(testing::shared_copy(map));
    const auto from_first = [](double x, double y) { return ManifoldPose{PatchId{0}, {x + 1, y, 0}}; };
    view_.team["R1"] = {
        from_first(-2, 2), from_first(2, -2), {from_first(-2, 2), from_first(2, 2), from_first(2, -2)}};
  }

  /// Whether R1's colour is drawn there, but for a share of what is below: lines are thin.
  bool is_drawn_at(const Eigen::Vector2d& point) {
    auto sheet = exploration_sheet(view_);
    const Eigen::Vector2d at = sheet.value().window().pixels(point);
    const Rgb drawn = sheet->canvas().pixel(static_cast<int>(at.x()), static_cast<int>(at.y()));
    const Rgb own = way_style(0).colour;
    return std::abs(drawn.red - own.red) + std::abs(drawn.green - own.green) +
               std::abs(drawn.blue - own.blue) <
           120;
  }

  Planner planner_;
  ExplorationView view_{20, planner_, {}, {}};
};

TEST_F(ExplorationPicture, ARobotsWayIsDrawnAndNoLineStraightToItsGoal) {
  EXPECT_TRUE(is_drawn_at({0, 2}));
  EXPECT_TRUE(is_drawn_at({2, 0}));
  EXPECT_TRUE(is_drawn_at({2, -2}));  // the mark of the goal
  EXPECT_FALSE(is_drawn_at({0, 0}));
}

TEST_F(ExplorationPicture, ARobotThatStandsHasAGoalAndNoWay) {
  view_.team["R1"].way.clear();
  EXPECT_FALSE(is_drawn_at({0, 2}));
  EXPECT_TRUE(is_drawn_at({2, -2}));
}

TEST_F(ExplorationPicture, NothingIsDrawnOfAMapOfNothing) {
  const Planner empty;
  EXPECT_FALSE(exploration_sheet({0, empty, {}, {}}).has_value());
}

}  // namespace
}  // namespace isthmus
