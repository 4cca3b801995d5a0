#include <gtest/gtest.h>

#include <cmath>

#include "tools/simulate/run/laser_model.hpp"
#include "tools/simulate/run/odometry_model.hpp"
#include "tools/simulate/run/sighting_model.hpp"

namespace isthmus {
namespace {

struct Spread {
  int n = 0;
  double sum = 0, squares = 0;
  void add(double value) {
    ++n;
    sum += value;
    squares += value * value;
  }
  double mean() const { return sum / n; }
  double sigma() const { return std::sqrt(squares / n - mean() * mean()); }
};

FloorPlan wall_at_4_m() {
  Building building;
  building.wall_thickness_m = 0;
  building.walls.push_back({{{4, -50}, {4, 50}}, false, {}});
  return build_floor_plan(building);
}

LaserPlan perfect_laser() {
  LaserPlan plan;
  plan.range_sigma_m = plan.bearing_sigma_rad = plan.dropout_share = 0;
  return plan;
}

TEST(Random, IsTheSameEverywhere) {
  Random random(1, "test");  // any change of these numbers changes every simulated log
  EXPECT_EQ(random.uniform(), 0.26470828173246375);
  EXPECT_NEAR(random.normal(), 0.83462919107434486, 1e-15);
  EXPECT_NEAR(random.normal(), -0.10398922395223116, 1e-15);
}

TEST(Random, StreamsAreIndependentOfOneAnother) {
  EXPECT_NE(Random(1, "test").uniform(), Random(1, "tests").uniform());
  EXPECT_NE(Random(1, "test").uniform(), Random(2, "test").uniform());
}

TEST(Random, NormalDeviatesHaveTheMomentsOfAGaussian) {
  Random random(1, "normal");
  Spread spread;
  int within = 0;
  for (int i = 0; i < 100000; ++i) {
    const double value = random.normal();
    spread.add(value);
    within += std::abs(value) < 1.96 ? 1 : 0;
  }
  EXPECT_NEAR(spread.mean(), 0, 0.015);
  EXPECT_NEAR(spread.sigma(), 1, 0.01);
  EXPECT_NEAR(within, 95000, 300);
}

TEST(Laser, RangesHaveTheirSigma) {
  LaserPlan plan = perfect_laser();
  plan.beams = 1;
  plan.range_sigma_m = 0.02;
  const RayCaster caster(wall_at_4_m());
  Random random(1, "laser");
  Spread spread;
  for (int i = 0; i < 20000; ++i) spread.add(take_scan(plan, caster, {}, {}, random).ranges_m.at(0));
  EXPECT_NEAR(spread.mean(), 4, 0.001);
  EXPECT_NEAR(spread.sigma(), 0.02, 0.001);
}

TEST(Laser, BearingNoiseShowsAtASlant) {
  LaserPlan plan = perfect_laser();
  plan.beams = 1;
  plan.bearing_sigma_rad = 0.003;
  const RayCaster caster(wall_at_4_m());
  Random random(1, "laser");
  Spread spread;
  const Pose pose{0, 0, std::numbers::pi / 4};  // range 4 / cos(yaw), so d range / d yaw = 4 sqrt(2)
  for (int i = 0; i < 20000; ++i) spread.add(take_scan(plan, caster, pose, {}, random).ranges_m.at(0));
  EXPECT_NEAR(spread.sigma(), 0.003 * 4 * std::sqrt(2.0), 0.0006);
}

TEST(Laser, SeesFromItsMountAndCountsBeamsFromTheRight) {
  LaserPlan plan = perfect_laser();
  plan.laser.robot_from_laser = {0.5, 0, 0};
  Random random(1, "laser");
  const Scan scan = take_scan(plan, RayCaster(wall_at_4_m()), {1, 0, 0}, {}, random);
  ASSERT_EQ(scan.ranges_m.size(), 181U);
  EXPECT_NEAR(scan.ranges_m[90], 2.5, 1e-6);
  EXPECT_NEAR(scan.bearing0_rad, -std::numbers::pi / 2, 1e-12);
  EXPECT_NEAR(scan.bearing_step_rad, std::numbers::pi / 180, 1e-12);
  Random again(1, "laser");
  const Scan turned = take_scan(plan, RayCaster(wall_at_4_m()), {1, 0, -std::numbers::pi / 4}, {}, again);
  EXPECT_TRUE(std::isinf(turned.ranges_m[0]));  // to the right and behind: nothing there
  EXPECT_FALSE(std::isinf(turned.ranges_m[135]));
}

TEST(Laser, NothingComesBackFromBeyondItsReach) {
  LaserPlan plan = perfect_laser();
  plan.laser.range_max_m = 3.5;
  Random random(1, "laser");
  const RayCaster caster(wall_at_4_m());
  EXPECT_TRUE(std::isinf(take_scan(plan, caster, {}, {}, random).ranges_m[90]));
  plan.no_return_is_infinite = false;
  EXPECT_EQ(take_scan(plan, caster, {}, {}, random).ranges_m[90], 3.5F);
}

TEST(Laser, SlantBeamsDoNotComeBackBeyondTheLimit) {
  LaserPlan plan = perfect_laser();
  plan.laser.range_max_m = 100;
  plan.return_limit_rad = 60 * std::numbers::pi / 180;
  Random random(1, "laser");
  const Scan scan = take_scan(plan, RayCaster(wall_at_4_m()), {}, {}, random);
  EXPECT_FALSE(std::isinf(scan.ranges_m[90 + 59]));
  EXPECT_TRUE(std::isinf(scan.ranges_m[90 + 61]));
}

TEST(Laser, DropoutsComeToTheirShare) {
  LaserPlan plan = perfect_laser();
  plan.dropout_share = 0.1;
  Random random(1, "laser");
  const RayCaster caster(wall_at_4_m());
  int dropped = 0;
  for (int i = 0; i < 100; ++i) {
    for (const float range : take_scan(plan, caster, {}, {}, random).ranges_m) dropped += range == 0 ? 1 : 0;
  }
  EXPECT_NEAR(dropped, 1810, 200);
}

TEST(Laser, NoReturnsComeToTheirShare) {
  LaserPlan plan = perfect_laser();
  plan.no_return_share = 0.12;
  Random random(1, "laser");
  const RayCaster caster(wall_at_4_m());
  int lost = 0;
  for (int i = 0; i < 100; ++i)
    lost += std::isinf(take_scan(plan, caster, {}, {}, random).ranges_m[90]) ? 1 : 0;
  EXPECT_NEAR(lost, 12, 9);
}

TEST(Laser, AScanTurnedAsideSaysSo) {
  Random random(1, "laser");
  const RayCaster caster(wall_at_4_m());
  const double aside = 0.1;
  const Scan scan = take_scan(perfect_laser(), caster, {}, {}, random, aside);
  EXPECT_NEAR(scan.bearing0_rad, -0.5 * std::numbers::pi + aside, 1e-12);
  EXPECT_NEAR(scan.ranges_m[90], 4 / std::cos(aside), 1e-6);
}

TEST(Laser, SeesOtherRobotsInFrontOfTheWallOnly) {
  Random random(1, "laser");
  const RayCaster caster(wall_at_4_m());
  EXPECT_NEAR(take_scan(perfect_laser(), caster, {}, {{{2, 0}, 0.2}}, random).ranges_m[90], 1.8, 1e-6);
  EXPECT_NEAR(take_scan(perfect_laser(), caster, {}, {{{6, 0}, 0.2}}, random).ranges_m[90], 4, 1e-6);
  EXPECT_NEAR(take_scan(perfect_laser(), caster, {}, {{{-2, 0}, 0.2}}, random).ranges_m[90], 4, 1e-6);
}

TEST(Laser, DeclaresItsMountWithTheSurveysError) {
  LaserPlan plan;
  plan.laser.robot_from_laser = {0.1, 0, 0};
  plan.declared_mount_error = {0.01, 0, 0.02};
  EXPECT_NEAR(declared_laser(plan).robot_from_laser.x, 0.11, 1e-12);
  EXPECT_NEAR(declared_laser(plan).robot_from_laser.yaw, 0.02, 1e-12);
}

// Drives `seconds` with constant v and omega, `runs` times; returns the spread of distance and yaw.
std::pair<Spread, Spread> drive_often(const OdometryPlan& plan, double v, double omega, double seconds,
                                      int runs) {
  Spread distance, yaw;
  for (int run = 0; run < runs; ++run) {
    OdometryModel model(plan, Random(static_cast<std::uint64_t>(run), "odometry"));
    Pose pose;
    for (double t = 0; t < seconds - 1e-9; t += 0.05) {
      const Pose next = pose * Pose{v * 0.05, 0, omega * 0.05};
      model.advance(pose, next, 0.05);
      pose = next;
    }
    distance.add(std::hypot(model.pose().x, model.pose().y));
    yaw.add(model.pose().yaw);
  }
  return {distance, yaw};
}

TEST(Odometry, NoiseHasTheSigmasOfItsModel) {
  // 10 s of independent periods of 0.2 s: a sigma of s a second grows to s sqrt(10 * 0.2).
  const auto [distance, yaw] = drive_often({}, 0.5, 0, 10, 3000);
  EXPECT_NEAR(distance.mean(), 5, 0.01);
  EXPECT_NEAR(distance.sigma(), 0.03 * 0.5 * std::sqrt(2.0), 0.0015);
  EXPECT_NEAR(yaw.sigma(), 0.0017 * std::sqrt(2.0), 0.00015);
  const auto [still, turned] = drive_often({}, 0, 0.2, 10, 3000);
  EXPECT_NEAR(turned.mean(), 2, 0.005);
  EXPECT_NEAR(turned.sigma(), (0.05 * 0.2 + 0.0017) * std::sqrt(2.0), 0.001);
}

TEST(Odometry, ScaleAndCurvatureAreSystematic) {
  OdometryPlan plan;
  plan.linear_share = plan.angular_share = plan.angular_floor_rps = 0;
  plan.linear_scale = 1.1;
  plan.curvature_rpm = 0.01;
  const auto [distance, yaw] = drive_often(plan, 0.5, 0, 2, 2);
  EXPECT_NEAR(distance.mean(), 1.1, 1e-3);
  EXPECT_NEAR(yaw.mean(), 0.01, 1e-9);
}

TEST(Odometry, StandsStillWithTheRobot) {
  OdometryModel model({}, Random(1, "odometry"));
  for (int i = 0; i < 100; ++i) model.advance({1, 2, 3}, {1, 2, 3}, 0.05);
  EXPECT_EQ(model.pose(), Pose{});
}

TEST(Sighting, HasItsSigmasAboutTheTruth) {
  const TrueSighting truth = true_sighting({1, 1, std::numbers::pi / 2}, {1, 4}, 7);
  EXPECT_NEAR(truth.range_m, 3, 1e-12);
  EXPECT_NEAR(truth.bearing_rad, 0, 1e-12);
  Random random(1, "sighting");
  Spread range, bearing;
  for (int i = 0; i < 20000; ++i) {
    const SightingEvent sighting = measure({}, truth, random);
    EXPECT_EQ(sighting.barcode, 7);
    range.add(sighting.range_m);
    bearing.add(sighting.bearing_rad);
  }
  EXPECT_NEAR(range.mean(), 3, 0.001);
  EXPECT_NEAR(range.sigma(), 0.02, 0.001);
  EXPECT_NEAR(bearing.mean(), 0, 0.002);
  EXPECT_NEAR(bearing.sigma(), 0.07, 0.002);
}

TEST(Sighting, NeedsRangeFieldOfViewAndLineOfSight) {
  const RayCaster caster(wall_at_4_m());
  CameraPlan camera;
  EXPECT_TRUE(in_sight(camera, caster, {}, {3, 0}));
  EXPECT_FALSE(in_sight(camera, caster, {}, {5, 0}));
  EXPECT_FALSE(in_sight(camera, caster, {}, {0, 8.1}));
  EXPECT_TRUE(in_sight(camera, caster, {}, {-3, 0}));
  camera.field_of_view_rad = std::numbers::pi / 2;
  EXPECT_FALSE(in_sight(camera, caster, {}, {-3, 0}));
  EXPECT_FALSE(in_sight(camera, caster, {}, {1, 1.1}));
}

TEST(Sighting, FalseOnesAreOffByMuchOrNameAnother) {
  Random random(1, "false");
  int wrong = 0;
  for (int i = 0; i < 1000; ++i) {
    SightingEvent sighting = measure({}, {7, 3, 0.5}, random);
    const SightingEvent honest = sighting;
    if (falsify(sighting, {6, 7, 8}, random) == "wrong_id") {
      ++wrong;
      EXPECT_NE(sighting.barcode, 7);
    } else {
      EXPECT_EQ(sighting.barcode, 7);
      const double range_off = std::abs(sighting.range_m - honest.range_m);
      const double bearing_off = std::abs(wrap_angle(sighting.bearing_rad - honest.bearing_rad));
      EXPECT_TRUE(range_off > 1 || bearing_off > 20 * std::numbers::pi / 180);
      EXPECT_GT(sighting.range_m, 0);
    }
  }
  EXPECT_NEAR(wrong, 500, 60);
}

}  // namespace
}  // namespace isthmus
