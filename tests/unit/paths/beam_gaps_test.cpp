#include "server/paths/ground/beam_gaps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "server/paths/ground/gaps.hpp"
#include "server/paths/questions/planner.hpp"
#include "tests/support/ground_scenes.hpp"

namespace isthmus {
namespace {

constexpr float lost = std::numeric_limits<float>::infinity();
constexpr float body = std::numeric_limits<float>::quiet_NaN();  // left out by the engine
constexpr double degree = std::numbers::pi / 180;

/// Beams a degree apart from straight ahead on, to the left or to the right.
Observation seen_by(std::vector<float> ranges_m, double step_rad = degree) {
  return observe({1, 0, step_rad, std::move(ranges_m)}, {Pose{}, 0.05, 8}, {});
}

TEST(BeamGaps, BetweenTwoBeamsThatCameBackAsFarAsTheNearerOneWent) {
  const auto gaps = find_beam_gaps(seen_by({3, 4, lost, lost, 2.5, 3}));
  ASSERT_EQ(gaps.size(), 1U);
  EXPECT_NEAR(gaps[0].from_rad, 1 * degree, 1e-9);
  EXPECT_NEAR(gaps[0].to_rad, 4 * degree, 1e-9);
  EXPECT_NEAR(gaps[0].range_m, 2.5, 1e-6);
}

TEST(BeamGaps, NoFartherThanARobotCouldHideIn) {
  std::vector<float> ranges_m(12, lost);  // 11 degrees: .5 m wide at 2.6 m
  ranges_m.front() = ranges_m.back() = 6;
  const auto gaps = find_beam_gaps(seen_by(ranges_m));
  ASSERT_EQ(gaps.size(), 1U);
  EXPECT_NEAR(2 * gaps[0].range_m * std::sin(5.5 * degree), max_gap_m, 1e-6);
}

TEST(BeamGaps, ABeamThatMayHaveMetSomethingNearMakesNone) {
  EXPECT_TRUE(find_beam_gaps(seen_by({3, lost, 0.01F, 3})).empty());
  EXPECT_TRUE(find_beam_gaps(seen_by({3, lost, -lost, lost, 3})).empty());
}

TEST(BeamGaps, ATeammatesBodyIsNothingThatStandsThere) {
  EXPECT_EQ(find_beam_gaps(seen_by({3, lost, body, body, lost, 3})).size(), 1U);
}

TEST(BeamGaps, AtTheEdgeOfTheViewIsNone) {
  EXPECT_TRUE(find_beam_gaps(seen_by({lost, lost, 3, 3})).empty());
  EXPECT_TRUE(find_beam_gaps(seen_by({3, 3, lost})).empty());
  EXPECT_TRUE(find_beam_gaps(seen_by({lost, lost})).empty());
  EXPECT_TRUE(find_beam_gaps(seen_by({})).empty());
}

TEST(BeamGaps, BeamsThatTurnToTheRightHaveThemToo) {
  const auto gaps = find_beam_gaps(seen_by({3, lost, 3, 3}, -degree));
  ASSERT_EQ(gaps.size(), 1U);
  EXPECT_NEAR(gaps[0].from_rad, -2 * degree, 1e-9);
  EXPECT_NEAR(gaps[0].to_rad, 0, 1e-9);
}

TEST(BeamGaps, OfAFullTurnTheLastAndTheFirstBeamAreNeighbours) {
  std::vector<float> ranges_m(360, 3);
  ranges_m[359] = ranges_m[0] = lost;
  const auto gaps = find_beam_gaps(seen_by(ranges_m));
  ASSERT_EQ(gaps.size(), 1U);
  EXPECT_TRUE(lies_in(gaps[0], {}, {2, 0}));
  EXPECT_FALSE(lies_in(gaps[0], {}, {-2, 0}));
}

TEST(BeamGaps, APointIsTakenFromTheRobotsFrame) {
  const Laser laser{{0.2, 0, std::numbers::pi}, 0.05, 8};  // looks backward
  const BeamGap gap{-2 * degree, 2 * degree, 2};
  EXPECT_TRUE(lies_in(gap, laser, {-1.7, 0}));
  EXPECT_FALSE(lies_in(gap, laser, {-1.9, 0}));
  EXPECT_FALSE(lies_in(gap, laser, {-1.7, 0.2}));
  EXPECT_FALSE(lies_in(gap, laser, {1, 0}));
}

/// A robot that looks along a corridor of 1.2 m whose end it does not see.
TEST(BeamGaps, ARobotCanDriveAheadInANarrowCorridorThatItSeesNoEndOf) {
  const testing::Walls walls = {{{-30, -0.6}, {30, -0.6}}, {{-30, 0.6}, {30, 0.6}}};
  Scan scan{1'000'000, -0.5 * std::numbers::pi, degree, {}};
  for (int beam = 0; beam <= 180; ++beam) {
    const double range = testing::range_to(walls, {0, 0}, scan.bearing0_rad + beam * degree);
    scan.ranges_m.push_back(range < 8 ? static_cast<float>(range) : lost);
  }
  Map map;
  map.add(make_patch(PatchId{0}, "R1", scan, {Pose{}, 0.05, 8}, {}), {});
  Planner planner;
  planner.update(testing::shared_copy(map));
  const auto to_x = [&](double x) {
    return planner.path({{PatchId{0}, {0, 0, 0}}, {PatchId{0}, {x, 0, 0}}, {0.22, 0.1}}).refusal;
  };
  EXPECT_EQ(to_x(2), Refusal::none);
  EXPECT_NE(to_x(6), Refusal::none) << "there it may be a robot's width that nobody has seen";
}

}  // namespace
}  // namespace isthmus
