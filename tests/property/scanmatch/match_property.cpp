#include <gtest/gtest.h>

#include "scanmatch/match.hpp"
#include "tests/property/drawn.hpp"
#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// A prediction within 15 cm and 0.1 rad: as far off as odometry may be from one scan to the next.
Pose off(const Pose& truth) {
  return truth * Pose{between(-0.15, 0.15), between(-0.15, 0.15), between(-0.1, 0.1)};
}

TEST(MatchScanProperty, FindsTheTruthFromAPredictionThatIsOff) {
  EXPECT_TRUE(rc::check([] {
    const Pose view{between(-0.5, 0.5), between(-0.5, 0.5), between(-0.3, 0.3)};
    const Pose truth{between(-0.8, 0.8), between(-0.8, 0.8), between(-0.4, 0.4)};
    const LocalMap map{PatchId{0}, {{patch_from(furnished_room(), PatchId{0}, view), view}}};
    const auto points = to_points(scan_from(furnished_room(), truth), laser_of(), {});
    const Match match = match_scan(map, points, {off(truth), Eigen::Matrix3d::Identity()}, {});
    RC_ASSERT(match.ok);
    const Pose error = ominus(match.local_from_robot, truth);
    RC_ASSERT(std::hypot(error.x, error.y) < 0.02);
    RC_ASSERT(std::abs(error.yaw) < 0.006);
  }));
}

TEST(MatchScanProperty, TheAnswerDoesNotDependOnTheFrameOfTheLocalMap) {
  EXPECT_TRUE(rc::check([] {
    const Pose view{between(-0.5, 0.5), between(-0.5, 0.5), between(-0.3, 0.3)};
    const Pose truth{between(-0.8, 0.8), between(-0.8, 0.8), between(-0.4, 0.4)};
    const Pose frame{between(-50, 50), between(-50, 50), between(-3, 3)};
    const Pose predicted = off(truth);
    const PatchPtr patch = patch_from(furnished_room(), PatchId{0}, view);
    const auto points = to_points(scan_from(furnished_room(), truth), laser_of(), {});
    const Eigen::Matrix3d information = Eigen::Matrix3d::Identity();
    const Match here = match_scan({PatchId{0}, {{patch, view}}}, points, {predicted, information}, {});
    const Match there =
        match_scan({PatchId{0}, {{patch, frame * view}}}, points, {frame * predicted, information}, {});
    RC_ASSERT(here.ok && there.ok);
    const Pose back = ominus(there.local_from_robot, frame);
    RC_ASSERT(std::abs(back.x - here.local_from_robot.x) < 1e-3);
    RC_ASSERT(std::abs(back.y - here.local_from_robot.y) < 1e-3);
    RC_ASSERT(std::abs(wrap_angle(back.yaw - here.local_from_robot.yaw)) < 1e-3);
  }));
}

TEST(MatchScanProperty, AnyScanIsSurvived) {
  EXPECT_TRUE(rc::check([] {
    const PatchPtr patch = patch_from(furnished_room(), PatchId{0}, {});
    Scan scan = scan_from(furnished_room(), {});
    for (float& range : scan.ranges_m) {
      if (*rc::gen::inRange(0, 3) == 0) range = static_cast<float>(between(-1, 25));
    }
    const Match match = match_scan({PatchId{0}, {{patch, {}}}}, to_points(scan, laser_of(), {}),
                                   {{}, Eigen::Matrix3d::Identity()}, {});
    RC_ASSERT(is_finite(match.local_from_robot));
    RC_ASSERT(match.beam_information.allFinite());
    RC_ASSERT(match.quality.score >= 0 && match.quality.score <= 1);
  }));
}

}  // namespace
}  // namespace isthmus
