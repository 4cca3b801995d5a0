#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>

#include "tools/evaluate/alignment.hpp"

namespace isthmus {
namespace {

double random_number() { return *rc::gen::inRange(-1000000, 1000000) * 1e-5; }
Pose drawn_pose() { return {random_number(), random_number(), wrap_angle(random_number())}; }

TEST(EvaluateProperty, TheNearestRowIsTheOneAFullSearchFinds) {
  EXPECT_TRUE(rc::check([] {
    const auto utimes =
        *rc::gen::container<std::vector<std::int64_t>>(rc::gen::inRange<std::int64_t>(0, 300));
    const auto asked = *rc::gen::inRange<std::int64_t>(-50, 350);
    const auto within = *rc::gen::inRange<std::int64_t>(0, 60);
    std::vector<StampedPose> rows;
    for (const std::int64_t utime : utimes) rows.push_back({utime, {}});
    const auto found = Trajectory(rows).nearest(asked, within);
    std::int64_t least = within + 1;
    for (const std::int64_t utime : utimes) least = std::min<std::int64_t>(least, std::abs(utime - asked));
    RC_ASSERT(found.has_value() == (least <= within));
    if (found) RC_ASSERT(std::abs(found->utime - asked) == least);
  }));
}

TEST(EvaluateProperty, AlignmentUndoesAnyMotion) {
  EXPECT_TRUE(rc::check([] {
    const Pose truth_from_map = drawn_pose();
    std::vector<PosePair> pairs;
    const int count = *rc::gen::inRange(2, 20);
    for (int i = 0; i < count; ++i) {
      const Pose map_from_robot = {random_number() + i, random_number(), random_number()};
      pairs.push_back({truth_from_map * map_from_robot, map_from_robot});
    }
    RC_PRE(std::hypot(pairs[0].map_from_robot.x - pairs[1].map_from_robot.x,
                      pairs[0].map_from_robot.y - pairs[1].map_from_robot.y) > 0.1);
    const Pose found = align(pairs);
    RC_ASSERT(std::abs(found.x - truth_from_map.x) < 1e-9);
    RC_ASSERT(std::abs(found.y - truth_from_map.y) < 1e-9);
    RC_ASSERT(std::abs(wrap_angle(found.yaw - truth_from_map.yaw)) < 1e-9);
  }));
}

TEST(EvaluateProperty, NoOtherMotionAlignsNoisyPairsBetter) {
  EXPECT_TRUE(rc::check([] {
    std::vector<PosePair> pairs;
    for (int i = 0; i < 8; ++i) pairs.push_back({drawn_pose(), drawn_pose()});
    const auto squares = [&](const Pose& truth_from_map) {
      double sum = 0;
      for (const PosePair& pair : pairs) {
        const Pose estimate = truth_from_map * pair.map_from_robot;
        sum += std::pow(estimate.x - pair.truth_from_robot.x, 2) +
               std::pow(estimate.y - pair.truth_from_robot.y, 2);
      }
      return sum;
    };
    const Pose best = align(pairs);
    const Pose other = {best.x + 0.01 * random_number(), best.y + 0.01 * random_number(),
                        best.yaw + 0.01 * random_number()};
    RC_ASSERT(squares(best) <= squares(other) * (1 + 1e-12));
  }));
}

}  // namespace
}  // namespace isthmus
