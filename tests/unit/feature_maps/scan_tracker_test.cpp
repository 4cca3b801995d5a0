#include "server/feature_maps/tracking/scan_tracker.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "server/feature_maps/mapper/feature_mapper.hpp"
#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using testing::Walls;

constexpr double half_second = 0.5;

/// A robot among walls that scans twice a second, and its odometry.
struct Way {
  explicit Way(double noise_scale = 2) {
    options.engine.odometry_noise.first_scale = noise_scale;
    tracker = ScanTracker(options.engine.odometry_noise);
  }

  FeatureMapOptions options = feature_map_options(FeatureMapKind::segments);
  ScanTracker tracker;
  std::int64_t utime = 1'000'000;

  std::optional<TrackedStep> scan(const Walls& walls, const Pose& stands, const Pose& told) {
    utime += static_cast<std::int64_t>(1e6 * half_second);
    return tracker.take(testing::scan_from(walls, stands, utime), testing::laser_of(), told, options.engine,
                        options.tracking);
  }
  /// Straight on, as odometry says.
  void drive(const Walls& walls, int scans) {
    for (int i = 0; i < scans; ++i) scan(walls, ahead(i), ahead(i));
  }
  Eigen::Matrix3d noise(const Pose& step) const {
    return tracker.noise().covariance(step, options.engine.odometry_noise);
  }
  static Pose ahead(int scans) { return {step_m * scans, 0, 0}; }

  static constexpr double step_m = 0.15;
};

TEST(ScanTracker, TellsNothingOfTheFirstScan) {
  Way way;
  EXPECT_FALSE(way.scan(testing::crooked_room(), {}, {}));
  EXPECT_TRUE(way.scan(testing::crooked_room(), Way::ahead(1), Way::ahead(1)));
}

TEST(ScanTracker, ASlipOfTheWheelsIsTheScansToTell) {
  Way way(0.5);
  way.drive(testing::crooked_room(), 4);
  const Pose slipped = Way::ahead(3) * Pose{0.1, -0.4, 0.4};  // pushed aside and turned
  const std::optional<TrackedStep> step = way.scan(testing::crooked_room(), slipped, Way::ahead(4));
  ASSERT_TRUE(step);
  EXPECT_TRUE(step->matched);
  const Pose went = ominus(slipped, Way::ahead(3));
  EXPECT_NEAR(step->from_last.x, went.x, 0.005);
  EXPECT_NEAR(step->from_last.y, went.y, 0.005);
  EXPECT_NEAR(step->from_last.yaw, went.yaw, 0.005) << "nothing of it is odometry's";
}

TEST(ScanTracker, WhereOdometryErrsByItsNoiseBothTellTheStep) {
  Way way;
  way.drive(testing::crooked_room(), 4);
  const Pose told = Way::ahead(3) * Pose{Way::step_m + 0.01, 0, 0.01};
  const std::optional<TrackedStep> step = way.scan(testing::crooked_room(), Way::ahead(4), told);
  ASSERT_TRUE(step);
  EXPECT_TRUE(step->matched);
  EXPECT_NEAR(step->from_last.x, Way::step_m, 0.008);
  EXPECT_NEAR(step->from_last.yaw, 0, 0.006);
  const Eigen::Matrix3d by_odometry = way.noise(Way::ahead(1));
  for (int i = 0; i < 3; ++i) EXPECT_LT(step->covariance(i, i), by_odometry(i, i));
}

TEST(ScanTracker, AlongACorridorOdometryTellsTheStep) {
  Way way;
  way.drive(testing::corridor(), 4);
  const std::optional<TrackedStep> step = way.scan(testing::corridor(), Way::ahead(4), Way::ahead(4));
  ASSERT_TRUE(step);
  EXPECT_NEAR(step->from_last.x, Way::step_m, 0.01);
  const Eigen::Matrix3d by_odometry = way.noise(Way::ahead(1));
  EXPECT_GT(step->covariance(0, 0), 0.5 * by_odometry(0, 0)) << "the scan tells little";
  EXPECT_LT(step->covariance(0, 0), 1.1 * by_odometry(0, 0)) << "odometry tells it";
  EXPECT_LT(step->covariance(1, 1), 0.5 * by_odometry(1, 1)) << "the scan tells how far the walls are";
}

TEST(ScanTracker, WhereNoScanFitsOdometryStands) {
  Way way;
  way.drive(testing::crooked_room(), 4);
  const Walls nothing = {{{100, 0}, {100, 1}}};
  const std::optional<TrackedStep> step = way.scan(nothing, Way::ahead(4), Way::ahead(4));
  ASSERT_TRUE(step);
  EXPECT_FALSE(step->matched);
  EXPECT_NEAR(step->from_last.x, Way::step_m, 1e-9);
  EXPECT_NEAR(step->from_last.yaw, 0, 1e-9);
}

}  // namespace
}  // namespace isthmus
