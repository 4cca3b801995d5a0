#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <cmath>
#include <limits>

#include "server/feature_maps/feature_estimator.hpp"
#include "server/feature_maps/output/feature_files.hpp"
#include "tests/property/drawn.hpp"
#include "tests/support/feature_events.hpp"

namespace isthmus {
namespace {

using testing::between;

/// Mostly plain numbers, sometimes none.
double number_of_any_kind(double reach) {
  const int kind = *rc::gen::inRange(0, 40);
  if (kind == 0) return std::numeric_limits<double>::quiet_NaN();
  if (kind == 1) return std::numeric_limits<double>::infinity();
  return between(-reach, reach);
}

Event arbitrary_event(std::int64_t utime) {
  const std::string robot = "R" + std::to_string(*rc::gen::inRange(1, 4));
  const std::int64_t stamp = utime + *rc::gen::inRange(-300'000, 300'000);
  switch (*rc::gen::inRange(0, 9)) {
    case 0: {
      RobotEvent event;
      event.robot = robot;
      event.barcode = *rc::gen::inRange(-1, 4);
      event.laser.range_max_m = *rc::gen::element(0.0, 8.0);
      event.restarted = *rc::gen::inRange(0, 10) == 0;
      return {utime, event};
    }
    case 1:
      return {utime, TagEvent{stamp, *rc::gen::inRange(0, 8)}};
    case 2:
    case 3: {
      const Pose pose{number_of_any_kind(5), number_of_any_kind(5), number_of_any_kind(3)};
      return {utime, OdometryEvent{robot, stamp, pose}};
    }
    case 4:
      return {utime, ScanEvent{robot, testing::scan_from(testing::furnished_room(),
                                                         {between(-1, 1), between(-1, 0.5), between(-3, 3)},
                                                         stamp)}};
    case 5: {
      const Verb verb = *rc::gen::element(Verb::withdraw, Verb::forbid, Verb::allow, Verb::drop);
      return {utime, CommandEvent{stamp, verb, *rc::gen::inRange(-1, 8), robot}};
    }
    default:
      return {utime, SightingEvent{robot, stamp, *rc::gen::inRange(0, 8), number_of_any_kind(8),
                                   number_of_any_kind(1), number_of_any_kind(3), number_of_any_kind(1)}};
  }
}

TEST(FeatureEstimatorProperty, WhateverComesTheMapsAreFiniteAndPositiveDefinite) {
  EXPECT_TRUE(rc::check([] {
    FeatureEstimator estimator(
        feature_map_options(*rc::gen::element(FeatureMapKind::segments, FeatureMapKind::points)));
    const int events = *rc::gen::inRange(0, 80);
    for (int i = 0; i < events; ++i) estimator.handle(arbitrary_event(1'000'000 + 50'000 * i));
    Outcome outcome;
    estimator.finish_step(outcome);
    const FeatureMaps maps = estimator.maps();
    for (const Team& team : maps.teams) {
      const Eigen::MatrixXd& covariance = team.filter.state().covariance;
      RC_ASSERT(covariance.allFinite());
      RC_ASSERT(covariance.isApprox(covariance.transpose(), 1e-6));
      for (Eigen::Index i = 0; i < covariance.rows(); ++i) RC_ASSERT(covariance(i, i) > 0);
      for (const FeatureInState& entry : team.filter.state().features) RC_ASSERT(is_sound(entry.feature));
    }
    for (const Journey& journey : maps.journeys)
      for (const JourneyRow& row : journey.rows) RC_ASSERT(is_finite(row.map_from_robot));
    RC_ASSERT(map_sha256(maps) == map_sha256(maps));
  }));
}

}  // namespace
}  // namespace isthmus
