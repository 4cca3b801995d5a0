#include "server/feature_maps/feature_estimator.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "server/engine/estimator.hpp"
#include "server/feature_maps/output/feature_files.hpp"
#include "server/feature_maps/output/feature_record.hpp"
#include "tests/support/feature_estimates.hpp"

namespace isthmus {
namespace {

using testing::FeatureEvents;
using testing::Walls;

constexpr double infinity = std::numeric_limits<double>::infinity();

const Pose start_1{-4, -1, 0.2}, start_2{5, -2, 3};

Walls furnished_hall() {
  Walls walls;
  testing::add_box(walls, -6, -4, 6, 4);
  testing::add_box(walls, 1, 1, 3, 2.2);
  return walls;
}

/// Two robots in a hall; `where` is where R2 is said to be, and where it is.
struct Hall {
  FeatureEvents run;
  int step = 0;

  Hall() {
    run.declare("R1", 101, 20);
    run.declare("R2", 102, 20);
  }
  Pose driven() const { return {0.1 * step, 0, 0.01 * step}; }
  Pose pose_1() const { return start_1 * driven(); }
  Pose pose_2() const { return start_2 * driven(); }

  void drive(int steps, bool with_scans = true) {
    for (int i = 0; i < steps; ++i) {
      run.odometry("R1", driven());
      run.odometry("R2", driven());
      if (with_scans) {
        run.scan("R1", furnished_hall(), pose_1());
        run.scan("R2", furnished_hall(), pose_2());
      }
      run.wait(0.2);
      ++step;
    }
    run.odometry("R1", driven());
    run.odometry("R2", driven());
  }
  /// Each sees the other, as if the second one were elsewhere.
  void meet(const Pose& moved = {}) {
    const Pose one = pose_1(), two = moved * pose_2();
    run.sighting("R1", 102, position(ominus(two, one)));
    run.sighting("R2", 101, position(ominus(one, two)));
    run.wait(3);
  }
};

Event order(const Hall& hall, Verb verb, std::int64_t closure, const std::string& robot = "") {
  return {hall.run.events.back().receive_utime, CommandEvent{0, verb, closure, robot}};
}

Hall met_hall() {
  Hall hall;
  hall.drive(15);
  hall.meet();
  hall.drive(5);
  hall.meet();
  hall.drive(5);
  return hall;
}

Pose one_from_two(const FeatureMaps& maps) {
  const auto& robots = maps.teams.at(0).filter.state().robots;
  const auto of = [&](std::size_t journey) {
    return robots.at(static_cast<std::size_t>(maps.journeys.at(journey).member)).map_from_robot;
  };
  return ominus(of(1), of(0));
}

TEST(FeatureEstimator, AWithdrawnFusionLeavesWhatAReplayWithoutItMakes) {
  const Hall hall = met_hall();
  FeatureEstimator live = estimate(hall.run);
  ASSERT_EQ(live.maps().teams.size(), 1u);
  const std::string before = map_sha256(live.maps());
  ASSERT_EQ(live.maps().fusions.size(), 1u);
  const std::int32_t id = live.maps().fusions[0].id;
  EXPECT_EQ(live.handle(order(hall, Verb::withdraw, id)).drop_reason, DropReason::none);
  EXPECT_EQ(live.maps().teams.size(), 2u);
  EXPECT_EQ(map_sha256(live.maps()), map_sha256(estimate(hall.run, {id}).maps()));
  EXPECT_EQ(live.handle(order(hall, Verb::allow, id)).drop_reason, DropReason::none);
  EXPECT_EQ(map_sha256(live.maps()), before);
}

TEST(FeatureEstimator, AForbiddenFusionStaysForbiddenWhateverElseSpeaksForIt) {
  Hall hall = met_hall();
  const std::int32_t id = estimate(hall.run).maps().fusions[0].id;
  for (int i = 0; i < 30; ++i) {
    hall.drive(1);
    hall.meet();
  }
  const FeatureMaps maps = estimate(hall.run, {id}).maps();
  EXPECT_EQ(maps.teams.size(), 2u);
  ASSERT_EQ(maps.fusions.size(), 1u);
  EXPECT_EQ(maps.fusions[0].state, FusionState::withdrawn);
}

TEST(FeatureEstimator, GoesOnAfterAWithdrawalAsIfTheFusionHadNeverBeen) {
  Hall hall = met_hall();
  const std::int32_t id = estimate(hall.run).maps().fusions[0].id;
  FeatureEvents with_order = hall.run;
  with_order.events.push_back(order(hall, Verb::withdraw, id));
  const std::size_t orders_at = with_order.events.size();
  hall.drive(10);
  with_order.events.insert(with_order.events.end(),
                           hall.run.events.begin() + static_cast<std::ptrdiff_t>(orders_at) - 1,
                           hall.run.events.end());
  EXPECT_EQ(map_sha256(estimate(with_order).maps()), map_sha256(estimate(hall.run, {id}).maps()));
}

TEST(FeatureEstimator, OrdersAboutWhatIsNotAreRefused) {
  const Hall hall = met_hall();
  FeatureEstimator live = estimate(hall.run);
  const std::string before = map_sha256(live.maps());
  EXPECT_EQ(live.handle(order(hall, Verb::withdraw, 77)).drop_reason, DropReason::no_such_closure);
  EXPECT_EQ(live.handle(order(hall, Verb::withdraw, -1)).drop_reason, DropReason::no_such_closure);
  EXPECT_EQ(live.handle(order(hall, Verb::allow, 0)).drop_reason, DropReason::not_forbidden);
  EXPECT_EQ(live.handle(order(hall, Verb::drop, -1, "R9")).drop_reason, DropReason::unknown_robot);
  EXPECT_EQ(live.handle(order(hall, Verb::allow, -1, "R1")).drop_reason, DropReason::not_dropped);
  EXPECT_EQ(map_sha256(live.maps()), before);
  EXPECT_EQ(live.copy().counters.dropped.at(DropReason::no_such_closure), 2);
}

TEST(FeatureEstimator, WhatADroppedRobotBroughtIsGoneAndComesBack) {
  const Hall hall = met_hall();
  FeatureEstimator live = estimate(hall.run);
  const std::string before = map_sha256(live.maps());
  EXPECT_EQ(live.handle(order(hall, Verb::drop, -1, "R2")).drop_reason, DropReason::none);
  const FeatureMaps without = live.maps();
  ASSERT_EQ(without.journeys.size(), 1u);
  EXPECT_EQ(without.journeys[0].robot, "R1");
  live.handle(order(hall, Verb::allow, -1, "R2"));
  EXPECT_EQ(map_sha256(live.maps()), before);
}

TEST(FeatureEstimator, AFusionThatLaterSightingsContradictIsTakenBack) {
  Hall hall;
  hall.drive(2, false);
  const Pose wrong{3, 2, 1.5};
  hall.meet(wrong);
  hall.drive(3, false);
  hall.meet(wrong);
  const FeatureMaps misled = estimate(hall.run).maps();
  ASSERT_EQ(misled.teams.size(), 1u) << "what agrees with itself is believed";
  for (int i = 0; i < 12; ++i) {
    hall.drive(2, false);
    hall.meet();
  }
  const FeatureMaps maps = estimate(hall.run).maps();
  EXPECT_EQ(maps.counts.withdrawn, 1);
  ASSERT_EQ(maps.teams.size(), 1u);
  const Pose found = one_from_two(maps), truth = ominus(hall.pose_2(), hall.pose_1());
  EXPECT_NEAR(found.x, truth.x, 0.05);
  EXPECT_NEAR(found.y, truth.y, 0.05);
  EXPECT_NEAR(wrap_angle(found.yaw - truth.yaw), 0, 0.02);
  const std::int32_t id = misled.fusions[0].id;
  EXPECT_EQ(map_sha256(maps), map_sha256(estimate(hall.run, {id}).maps()));
}

TEST(FeatureEstimator, OneFalseSightingChangesNoMap) {
  Hall hall;
  hall.drive(15);
  hall.run.sighting("R1", 102, {2, 2});
  hall.drive(5);
  EXPECT_EQ(estimate(hall.run).maps().teams.size(), 2u);
  hall.run.sighting("R2", 101, {1, -2});
  hall.drive(5);
  EXPECT_EQ(estimate(hall.run).maps().teams.size(), 2u);
}

TEST(FeatureEstimator, SightingsOfOneRobotByTheOtherMakeOneMapInTheEnd) {
  Hall hall;
  for (int i = 0; i < 6; ++i) {
    hall.drive(5);
    hall.run.sighting("R1", 102, position(ominus(hall.pose_2(), hall.pose_1())));
    hall.run.wait(3);
  }
  hall.drive(1);
  --hall.step;  // where the last scans are
  const FeatureMaps maps = estimate(hall.run).maps();
  ASSERT_EQ(maps.teams.size(), 1u);
  const Pose found = one_from_two(maps), truth = ominus(hall.pose_2(), hall.pose_1());
  EXPECT_NEAR(found.x, truth.x, 0.05);
  EXPECT_NEAR(found.y, truth.y, 0.05);
  EXPECT_NEAR(wrap_angle(found.yaw - truth.yaw), 0, 0.02);
}

TEST(FeatureEstimator, FixedBarcodesThatBothKnowMakeOneMap) {
  Hall hall;
  const std::vector<Eigen::Vector2d> places = {{-1, 3.9}, {2, 3.9}, {5.9, 1}, {1, -3.9}};
  for (int i = 0; i < 4; ++i) hall.run.tag(i);
  hall.drive(5);
  for (int i = 0; i < 4; ++i) {
    hall.run.sighting("R1", i, inverse(hall.pose_1()) * places[static_cast<std::size_t>(i)]);
    hall.run.sighting("R2", i, inverse(hall.pose_2()) * places[static_cast<std::size_t>(i)]);
    hall.drive(3);
  }
  const FeatureMaps maps = estimate(hall.run).maps();
  ASSERT_EQ(maps.teams.size(), 1u);
  EXPECT_EQ(maps.teams[0].landmarks.size(), 4u);
  std::size_t points = 0;
  for (const FeatureInState& entry : maps.teams[0].filter.state().features)
    points += entry.feature.kind == FeatureKind::point ? 1 : 0;
  EXPECT_EQ(points, 4u) << "none is there twice";
}

TEST(FeatureEstimator, ARangeOrABearingAloneCorrectsAMapAndNoneOfBothIsRefused) {
  for (const bool range : {true, false}) {
    Hall hall = met_hall();
    const auto sigma = [](const FeatureMaps& maps) {
      const FeatureState& state = maps.teams.at(0).filter.state();
      const auto measured = measure_robot(state, {0, 1, 1, 0, 1, 1});
      return innovation_covariance(state.covariance, *measured);
    };
    const LocalMatrix before = sigma(estimate(hall.run).maps());
    const Eigen::Vector2d seen = position(ominus(hall.pose_2(), hall.pose_1()));
    hall.run.add(SightingEvent{"R1", hall.run.events.back().receive_utime, 102, range ? seen.norm() : 0,
                               range ? 1e-4 : infinity, range ? 0 : std::atan2(seen.y(), seen.x()),
                               range ? infinity : 1e-4});
    const FeatureMaps after = estimate(hall.run).maps();
    EXPECT_TRUE(after.sightings.back().used) << after.sightings.back().reason;
    const Eigen::Index which = range ? 0 : 1;
    EXPECT_LT(sigma(after)(which, which) - 1, 0.5 * (before(which, which) - 1));
    hall.run.add(SightingEvent{"R1", hall.run.events.back().receive_utime, 102, 1, infinity, 0, infinity});
    EXPECT_EQ(estimate(hall.run).maps().sightings.back().reason, "incomplete");
  }
}

TEST(FeatureEstimator, ALongLookAtOneAnotherIsOneEncounter) {
  Hall hall;
  hall.drive(2, false);
  for (int i = 0; i < 20; ++i) {  // two seconds
    hall.run.sighting("R1", 102, position(ominus(hall.pose_2(), hall.pose_1())));
    hall.run.sighting("R2", 101, position(ominus(hall.pose_1(), hall.pose_2())));
    hall.run.wait(0.1);
  }
  const FeatureMaps maps = estimate(hall.run).maps();
  EXPECT_EQ(maps.teams.size(), 2u);
  ASSERT_EQ(maps.fusions.size(), 1u);
  EXPECT_EQ(maps.fusions[0].clues, 2u);
}

TEST(FeatureEstimator, ItsRecordTellsOfRobotsSightingsAndFusions) {
  const Hall hall = met_hall();
  const MapCopy copy = estimate(hall.run).copy();
  EXPECT_EQ(copy.feature_islands, 1u);
  ASSERT_EQ(copy.health.size(), 2u);
  EXPECT_EQ(copy.health[1].robot, "R2");
  ASSERT_EQ(copy.closures.size(), 1u);
  EXPECT_EQ(copy.closures[0].state, ClosureState::accepted);
  EXPECT_EQ(copy.sightings.count(Verdict::accepted), 4);
  EXPECT_EQ(copy.counters.scans, 50);
}

/// A sighting's verdict may change long after it came, where two maps become one.
TEST(FeatureEstimator, SightingsAreToldAsTheyStandAtAnyTime) {
  const Hall hall = met_hall();
  FeatureEstimator live(feature_map_options(FeatureMapKind::segments));
  std::size_t waited = 0;
  for (const Event& event : hall.run.events) {
    live.handle(event);
    const MapCopy copy = live.copy();
    const std::vector<FeatureSighting> now = live.maps().sightings;
    ASSERT_EQ(copy.sightings.size(), now.size());
    EXPECT_EQ(copy.counters.sightings, static_cast<std::int64_t>(now.size()));
    for (std::size_t i = 0; i < now.size(); ++i) {
      const SightingRecord expected = record_of(now[i]), told = copy.sightings[i];
      EXPECT_EQ(told.verdict, expected.verdict);
      EXPECT_EQ(told.reason, expected.reason);
      EXPECT_EQ(told.closure, expected.closure);
      EXPECT_EQ(told.sighting.utime, now[i].sighting.utime);
    }
    waited += static_cast<std::size_t>(copy.sightings.count(Verdict::waiting));
  }
  EXPECT_GT(waited, 0U);
  EXPECT_EQ(live.copy().sightings.count(Verdict::accepted), 4);
  const std::vector<std::uint8_t> saved = live.save();
  EXPECT_EQ(
      FeatureEstimator::restore(FeatureMapKind::segments, saved).copy().sightings.count(Verdict::accepted),
      4);
}

TEST(FeatureEstimator, WhatIsRestoredFromItsBytesGoesOnAsItWouldHave) {
  const Hall hall = met_hall();
  for (const std::size_t share : {1U, 3U, 5U, 9U}) {
    const std::size_t split = hall.run.events.size() * share / 10;
    FeatureEstimator live(feature_map_options(FeatureMapKind::segments));
    for (std::size_t i = 0; i < split; ++i) live.handle(hall.run.events[i]);
    const std::vector<std::uint8_t> saved = live.save();
    FeatureEstimator restored = FeatureEstimator::restore(FeatureMapKind::segments, saved);
    EXPECT_EQ(restored.save(), saved);
    EXPECT_EQ(restored.maps().teams.at(0).filter.options().association.probability,
              live.maps().teams.at(0).filter.options().association.probability);
    for (std::size_t i = split; i < hall.run.events.size(); ++i) restored.handle(hall.run.events[i]);
    Outcome outcome;
    restored.finish_step(outcome);
    EXPECT_EQ(map_sha256(restored.maps()), map_sha256(estimate(hall.run).maps()));
    const std::int32_t id = restored.maps().fusions.at(0).id;
    EXPECT_EQ(restored.handle(order(hall, Verb::withdraw, id)).drop_reason, DropReason::none);
    EXPECT_EQ(map_sha256(restored.maps()), map_sha256(estimate(hall.run, {id}).maps()))
        << "what it was made of is saved too";
  }
}

/// A corridor with niches, of 60 walls a side.
Walls niched_corridor() {
  Walls walls;
  testing::add_box(walls, -2, -4, 45, 4);
  for (int i = 0; i < 20; ++i)
    for (const double y : {-3.5, 1.5}) testing::add_box(walls, 2 * i, y, 2 * i + 1.1, y + 2);
  return walls;
}

TEST(FeatureEstimator, WhatIsRestoredFarFromWhereItBeganGoesOnAsItWouldHave) {
  FeatureEvents run;
  run.declare("R1", 101, 8);
  const Walls walls = niched_corridor();
  for (int step = 0; step < 190; ++step) {
    const Pose driven{step < 150 ? 0.25 * step : 0.25 * (300 - step), 0, 0};
    run.odometry("R1", driven);
    run.scan("R1", walls, driven);
    run.wait(0.2);
  }
  const std::size_t split = run.events.size() * 3 / 4;
  FeatureEstimator live(feature_map_options(FeatureMapKind::segments));
  for (std::size_t i = 0; i < split; ++i) live.handle(run.events[i]);
  const FeatureMaps maps = live.maps();
  EXPECT_GT(maps.teams.at(0).filter.feature_count(), 60U);  // enough for some to be set aside
  EXPECT_EQ(maps.teams.at(0).filter.state().features.size(), maps.teams.at(0).filter.feature_count())
      << "all of it is in what is written";
  const std::vector<std::uint8_t> saved = live.save();
  FeatureEstimator restored = FeatureEstimator::restore(FeatureMapKind::segments, saved);
  EXPECT_EQ(restored.save(), saved);
  EXPECT_EQ(map_sha256(restored.maps()), map_sha256(live.maps()));
  for (std::size_t i = split; i < run.events.size(); ++i)
    for (FeatureEstimator* estimator : {&live, &restored}) estimator->handle(run.events[i]);
  EXPECT_EQ(map_sha256(restored.maps()), map_sha256(live.maps()));
}

TEST(FeatureEstimator, WhatIsRestoredBetweenAMeetingAndAWallInCommonComesToTheSameMap) {
  FeatureEvents run;
  run.declare("R1", 101, 4);
  run.declare("R2", 102, 4);
  const Walls walls = testing::niched_hall();
  const Pose begin_1{2, 0, 0}, begin_2{17, 0, 3.1};
  std::size_t split = 0;
  for (int step = 0; step < 110; ++step) {
    const Pose driven_1{step < 10 ? 0.15 * step : 1.35, 0, 0}, driven_2{0.15 * step, 0, 0};
    const Pose one = begin_1 * driven_1, two = begin_2 * driven_2;
    run.odometry("R1", driven_1);
    run.odometry("R2", driven_2);
    run.scan("R1", walls, one);
    run.scan("R2", walls, two);
    run.wait(0.2);
    if (step != 10) continue;
    for (int meeting = 0; meeting < 3; ++meeting) {
      run.sighting("R1", 102, position(ominus(two, one)));
      run.sighting("R2", 101, position(ominus(one, two)));
      run.wait(3);
      run.odometry("R1", driven_1);
      run.odometry("R2", driven_2);
    }
    split = run.events.size() + 12;
  }
  FeatureEstimator live(feature_map_options(FeatureMapKind::segments));
  for (std::size_t i = 0; i < split; ++i) live.handle(run.events[i]);
  ASSERT_EQ(live.maps().teams.size(), 2U);
  EXPECT_EQ(live.maps().teams[0].filter.state().marks.size(), 1U);
  const std::vector<std::uint8_t> saved = live.save();
  FeatureEstimator restored = FeatureEstimator::restore(FeatureMapKind::segments, saved);
  EXPECT_EQ(restored.save(), saved);
  for (std::size_t i = split; i < run.events.size(); ++i) restored.handle(run.events[i]);
  Outcome outcome;
  restored.finish_step(outcome);
  EXPECT_EQ(restored.maps().teams.size(), 1U);
  EXPECT_EQ(map_sha256(restored.maps()), map_sha256(estimate(run).maps()));
}

TEST(FeatureEstimator, BytesThatAreNotWhatWasSavedAreRefused) {
  const std::vector<std::uint8_t> saved = estimate(met_hall().run).save();
  for (std::size_t size = 0; size < saved.size(); size += 4001)
    EXPECT_THROW(FeatureEstimator::restore(FeatureMapKind::segments, std::span(saved).first(size)),
                 std::exception);
  std::vector<std::uint8_t> longer = saved;
  longer.push_back(0);
  EXPECT_THROW(FeatureEstimator::restore(FeatureMapKind::segments, longer), std::exception);
  for (std::size_t at = 0; at < saved.size(); at += 1009) {  // anything but a crash
    std::vector<std::uint8_t> other = saved;
    other[at] ^= 0xff;
    try {
      FeatureEstimator restored = FeatureEstimator::restore(FeatureMapKind::segments, other);
      Outcome outcome;
      restored.finish_step(outcome);
      map_sha256(restored.maps());
    } catch (const std::exception&) {
    }
  }
}

TEST(FeatureEstimator, OrdersAboutPatchesAreRefusedInWords) {
  const Hall hall = met_hall();
  FeatureEstimator live = estimate(hall.run);
  const std::int64_t now = hall.run.events.back().receive_utime;
  const std::string before = map_sha256(live.maps());
  EXPECT_EQ(live.handle(order(hall, Verb::refine, -1)).drop_reason, DropReason::no_manifold);
  EXPECT_EQ(live.handle({now, AnnotationEvent()}).drop_reason, DropReason::no_manifold);
  EXPECT_EQ(live.handle({now, InitialPoseEvent()}).drop_reason, DropReason::no_manifold);
  EXPECT_EQ(live.copy().counters.dropped.at(DropReason::no_manifold), 3);
  EXPECT_EQ(map_sha256(live.maps()), before);
}

TEST(FeatureEstimator, StrangersChangeNothing) {
  const Hall hall = met_hall();
  FeatureEstimator live = estimate(hall.run);
  const std::string before = map_sha256(live.maps());
  const Event stranger{hall.run.events.back().receive_utime, OdometryEvent{"R9", 1, {}}};
  EXPECT_TRUE(live.is_stranger(stranger));
  EXPECT_EQ(live.handle(stranger).drop_reason, DropReason::unknown_robot);
  EXPECT_EQ(map_sha256(live.maps()), before);
}

}  // namespace
}  // namespace isthmus
