#include "server/engine/robot/robot_health.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "server/engine/robot/health_warnings.hpp"

namespace isthmus {
namespace {

using std::numbers::pi;

const Laser laser_of_30_m{Pose{}, 0.05, 30};

Scan scan_with(std::size_t beams, std::size_t hits) {
  Scan scan{1, -1.5, 0.01, {}};
  for (std::size_t i = 0; i < beams; ++i)
    scan.ranges_m.push_back(i < hits ? 3.0F : std::numeric_limits<float>::infinity());
  return scan;
}

// A robot that drives in curves, 0.1 m a scan; what odometry makes of each step is given.
template <class Odometry>
RobotHealth driven(Odometry odometry, bool well_seen = true, int scans = 200) {
  RobotHealth health;
  Pose odom_from_robot;
  for (int i = 0; i < scans; ++i) {
    const Pose step{0.1, 0, 0.1 * std::sin(0.5 * i)};
    const Pose told = odometry(step);
    odom_from_robot = odom_from_robot * told;
    health.heard_odometry(odom_from_robot);
    health.heard_scan(scan_with(181, 100), laser_of_30_m, {}, {});
    health.matched(told, step, well_seen, {});
  }
  return health;
}

std::vector<std::string> keys(const RobotHealth& health) {
  std::vector<std::string> all;
  for (const HealthWarning& warning : health_warnings("R1", laser_of_30_m, health.figures({}), {}, {}))
    all.push_back(warning.key);
  return all;
}

using Keys = std::vector<std::string>;

/// Whose stamps lie so far from the times of their receipt, the first few ten minutes more behind.
RobotHealth with_clock_ahead(double ahead_s) {
  RobotHealth health = driven([](const Pose& step) { return step; });
  const auto ahead_us = static_cast<std::int64_t>(1e6 * ahead_s);
  for (std::int64_t utime = 0; utime < 100'000'000; utime += 1'000'000)
    health.heard_stamp(utime + ahead_us, utime < 10'000'000 ? utime + 600'000'000 : utime + 20'000);
  return health;
}

TEST(RobotHealth, AClockOfAnotherTimeIsTold) {
  EXPECT_EQ(keys(with_clock_ahead(3600)), Keys{"clock_ahead"});
  EXPECT_EQ(keys(with_clock_ahead(-3600)), Keys{"clock_behind"});
  EXPECT_NEAR(*with_clock_ahead(3600).figures({}).clock_ahead_s, 3600, 0.1);
}

// What comes late out of a radio shadow says nothing of the clock.
TEST(RobotHealth, HowFarAClockIsOffIsToldInAUnitThatOneCanRead) {
  const auto told = [](double ahead_s) {
    return health_warnings("R1", laser_of_30_m, with_clock_ahead(ahead_s).figures({}), {}, {})[0].text;
  };
  EXPECT_EQ(told(3600), "R1's clock is ahead by 60 minutes: its sightings cannot be paired");
  EXPECT_EQ(told(-95'557'795),
            "R1's clock is behind by 1106 days, or all that it sent came so late: its "
            "sightings may not be paired");
}

// Nothing of it can be matched, and its odometry does not stand still: it is not there.
TEST(RobotHealth, WhoseOdometryIsRefusedHasThatWarningAlone) {
  RobotHealth health;
  for (int i = 0; i < 200; ++i) {
    health.heard_scan(scan_with(181, static_cast<std::size_t>(60 + i % 120)), laser_of_30_m, {}, {});
    health.unmatched();
  }
  const auto warnings =
      health_warnings("R1", laser_of_30_m, health.figures({}), {{DropReason::absurd_value, 20}}, {});
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0].text, "R1 sends scans and no odometry of it was taken; dropped: absurd_value 20");
}

TEST(RobotHealth, DataThatComesLateIsNoClockBehind) { EXPECT_EQ(keys(with_clock_ahead(0)), Keys{}); }

TEST(RobotHealth, OdometryThatAgreesWarnsOfNothing) {
  const RobotHealth health = driven([](const Pose& step) {
    return Pose{1.03 * step.x, 0.002, 1.05 * step.yaw};
  });
  EXPECT_EQ(keys(health), Keys{});
  const HealthFigures figures = health.figures({});
  EXPECT_NEAR(figures.way.laser, 20, 0.5);
  EXPECT_GT(figures.way.explained(), 0.9);
  EXPECT_NEAR(figures.way.ratio(), 1.03, 0.01);
  EXPECT_NEAR(figures.direction_rad, 0, 0.05);
  EXPECT_EQ(figures.best_lag_scans, 0);
}

TEST(RobotHealth, OdometryThatNeverMoves) {
  EXPECT_EQ(keys(driven([](const Pose&) { return Pose{}; })), Keys{"odometry_still"});
}

TEST(RobotHealth, OdometryInAnotherUnit) {
  for (const double unit : {1000.0, 100.0, 39.37, 3.281, 0.001}) {
    const RobotHealth health = driven([&](const Pose& step) { return Pose{unit * step.x, 0, step.yaw}; });
    ASSERT_EQ(keys(health), Keys{"odometry_unit"}) << unit;
  }
  const RobotHealth health = driven([&](const Pose& step) { return Pose{1000 * step.x, 0, step.yaw}; });
  const std::string text = health_warnings("R1", laser_of_30_m, health.figures({}), {}, {}).at(0).text;
  EXPECT_NE(text.find("is 1000 times"), std::string::npos) << text;
  EXPECT_NE(text.find("millimetres"), std::string::npos) << text;
}

TEST(RobotHealth, TurnsInDegreesForRadians) {
  EXPECT_EQ(keys(driven([](const Pose& step) {
              return Pose{step.x, 0, wrap_angle(step.yaw * 180 / pi)};
            })),
            Keys{"turn_unit"});
}

TEST(RobotHealth, LaserMountedBackwardsOrUpsideDown) {
  EXPECT_EQ(keys(driven([](const Pose& step) {
              return Pose{-step.x, 0, step.yaw};
            })),
            Keys{"mount_backwards"});
  EXPECT_EQ(keys(driven([](const Pose& step) {
              return Pose{step.x, 0, -step.yaw};
            })),
            Keys{"mount_mirrored"});
  EXPECT_EQ(keys(driven([](const Pose& step) { return Pose{0, step.x, step.yaw}; })), Keys{"mount_turned"});
}

TEST(RobotHealth, OdometryOfAnotherMotion) {
  double angle = 0;
  const auto elsewhere = [&](const Pose& step) {
    angle += 2.4;
    return Pose{0.2 * std::cos(angle), 0.2 * std::sin(angle), step.yaw};
  };
  const Keys found = keys(driven(elsewhere));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found[0] == "odometry_unrelated" || found[0] == "odometry_unit") << found[0];
}

TEST(RobotHealth, LateOdometry) {
  std::vector<Pose> waiting(3);
  const auto late = [&](const Pose& step) {
    waiting.push_back(step);
    const Pose then = waiting[waiting.size() - 4];
    return Pose{step.x, 0, then.yaw};
  };
  const RobotHealth health = driven(late);
  EXPECT_EQ(health.figures({}).best_lag_scans, 3);
  const Keys found = keys(health);
  EXPECT_NE(std::ranges::find(found, "time_offset"), found.end());
}

// A robot that turns to and fro for so many scans, its odometry so many scans late, both with a little noise.
RobotHealth driven_late(double late_scans, int scans = 1000) {
  RobotHealth health;
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 0.005);
  const auto yaw = [](double scan) { return 0.8 * std::sin(0.3 * scan) + 0.5 * std::sin(0.17 * scan); };
  const auto turn = [&](double scan) { return yaw(scan) - yaw(scan - 1); };
  for (int i = 0; i < scans; ++i)
    health.matched({0.1, 0, turn(i - late_scans) + noise(random)}, {0.1, 0, turn(i) + noise(random)}, true,
                   {});
  return health;
}

TEST(RobotHealth, OffsetOfOdometryToATenthOfAScan) {
  for (const double late_scans : {-1.6, -1.0, -0.6, -0.3, 0.0, 0.3, 0.8}) {
    const HealthFigures figures = driven_late(late_scans).figures({});
    ASSERT_TRUE(figures.offset_scans);
    EXPECT_NEAR(*figures.offset_scans, late_scans, 0.11);
    if (std::abs(late_scans) > 0.2) {
      EXPECT_LT(figures.off_at_offset, 0.7) << late_scans;
    }
  }
}

TEST(RobotHealth, NoOffsetBeforeTheRobotHasTurnedEnough) {
  EXPECT_FALSE(driven_late(-0.6, 20).figures({}).offset_scans);
}

// In a corridor a match only repeats what odometry says of the way along it.
TEST(RobotHealth, WaysThatTheLaserLeavesOpenAreLeftOut) {
  const RobotHealth health = driven([](const Pose& step) { return step; }, false);
  EXPECT_EQ(health.figures({}).way.laser, 0);
  EXPECT_GT(health.figures({}).turn.laser, 2);
}

// Matches of a robot at rest tremble; that is no motion.
TEST(RobotHealth, TremblingAtRestIsNoMotion) {
  RobotHealth health;
  for (int i = 0; i < 10'000; ++i) {
    health.heard_odometry(Pose{});
    health.heard_scan(scan_with(181, 100), laser_of_30_m, {}, {});
    const double off = i % 2 == 0 ? 0.004 : -0.003;
    health.matched(Pose{}, Pose{off, off, 0.1 * off}, true, {});
  }
  EXPECT_EQ(keys(health), Keys{});
}

TEST(RobotHealth, ScansThatSayNothing) {
  RobotHealth none, one_beam, few, without;
  for (int i = 0; i < 100; ++i) {
    none.heard_odometry(Pose{0.1 * i, 0, 0});
    one_beam.heard_odometry(Pose{0.1 * i, 0, 0});
    one_beam.heard_scan(scan_with(1, 1), laser_of_30_m, {}, {});
    one_beam.unmatched();
    few.heard_odometry(Pose{0.1 * i, 0, 0});
    few.heard_scan(scan_with(181, i % 4 == 0 ? 50 : 5), laser_of_30_m, {}, {});
    without.heard_odometry(Pose{0.1 * i, 0, 0});
    without.heard_scan(scan_with(181, 0), laser_of_30_m, {}, {});
    without.unmatched();
  }
  EXPECT_EQ(keys(none), Keys{"no_scans"});
  EXPECT_EQ(keys(one_beam), Keys{"few_beams"});
  EXPECT_EQ(keys(few), Keys{"few_returns"});
  EXPECT_EQ(keys(without), Keys{"no_returns"});
  EXPECT_EQ(health_warnings("R1", laser_of_30_m, without.figures({}), {}, {}).at(0).text.substr(0, 25),
            "no scan of R1 had a retur");
}

TEST(RobotHealth, ScansWithoutOdometry) {
  RobotHealth health;
  for (int i = 0; i < 100; ++i) health.heard_scan(scan_with(181, 100), laser_of_30_m, {}, {});
  const auto warnings =
      health_warnings("R1", laser_of_30_m, health.figures({}), {{DropReason::absurd_value, 7}}, {});
  ASSERT_FALSE(warnings.empty());
  EXPECT_EQ(warnings[0].key, "no_odometry");
  EXPECT_NE(warnings[0].text.find("absurd_value 7"), std::string::npos);
}

// Nothing is said of a robot without a laser, nor before enough is known.
TEST(RobotHealth, SilentWhereNothingIsKnown) {
  EXPECT_EQ(keys(driven([](const Pose&) { return Pose{}; }, true, 10)), Keys{});
  RobotHealth blind;
  for (int i = 0; i < 100; ++i) blind.heard_odometry(Pose{0.1 * i, 0, 0});
  EXPECT_TRUE(health_warnings("R1", Laser{Pose{}, 0, 0}, blind.figures({}), {}, {}).empty());
}

}  // namespace
}  // namespace isthmus
