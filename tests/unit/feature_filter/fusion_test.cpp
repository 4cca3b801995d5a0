#include "server/features/fusion/fusion.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>

#include "server/features/feature_filter.hpp"

namespace isthmus {
namespace {

/// Two robots in a hall of posts, each with a frame of its own, driving towards one another.
struct TwoMaps {
  std::vector<Eigen::Vector2d> posts;
  FeatureState one, two;
  std::vector<int> post_of_one, post_of_two;  ///< by feature id
  Pose truth_one, truth_two;                  ///< of the robots at the end
  Pose start_one{0, 0, 0}, start_two{40, 2, 3};
  std::mt19937 random;

  explicit TwoMaps(std::uint32_t seed, double spacing_m = 3) : random(seed) {
    for (double x = -6; x <= 46; x += spacing_m)
      for (double y : {-6.0, -2.5, 4.5, 8.0}) posts.emplace_back(x + 0.7 * normal(), y + 0.5 * normal());
    truth_one = drive(start_one, 0.02, one, post_of_one);
    truth_two = drive(start_two, -0.02, two, post_of_two);
  }

  double normal() { return std::normal_distribution<double>()(random); }

  Pose drive(const Pose& start, double turn_rad, FeatureState& state, std::vector<int>& post_of) {
    FeatureFilter filter;
    filter.add_robot({}, Eigen::Matrix3d::Zero());
    std::vector<int> ids(posts.size(), -1);
    Pose truth = start;
    for (int step = 0; step < 45; ++step) {
      const Pose move{0.5, 0, step < 5 ? 0 : turn_rad * std::sin(0.3 * step)};
      truth = truth * move;
      filter.move(0, {move.x + 0.01 * normal(), 0.01 * normal(), move.yaw + 0.01 * normal()},
                  1e-4 * Eigen::Matrix3d::Identity());
      std::vector<ObservedFeature> seen;
      std::vector<int> which, known;
      for (std::size_t i = 0; i < posts.size(); ++i) {
        const Eigen::Vector2d there = inverse(truth) * posts[i];
        if (there.norm() > 8 || there.x() < 0) continue;
        const Eigen::Vector2d noise(0.05 * normal(), 0.05 * normal());
        seen.push_back({point_feature(there + noise), 0.0025 * LocalMatrix::Identity(2, 2)});
        which.push_back(static_cast<int>(i));
        known.push_back(ids[i]);
      }
      const std::vector<int> now = filter.observe_known(0, seen, known);
      for (std::size_t k = 0; k < now.size(); ++k) ids[static_cast<std::size_t>(which[k])] = now[k];
    }
    state = filter.state();
    post_of.assign(state.features.size(), -1);
    for (std::size_t i = 0; i < ids.size(); ++i)
      if (ids[i] >= 0) post_of[static_cast<std::size_t>(ids[i])] = static_cast<int>(i);
    return truth;
  }

  RobotAlignment meet(double range_sigma_m = 0.02, double bearing_sigma_rad = 0.07) {
    const Pose one_from_two = ominus(truth_two, truth_one);
    const Pose back = inverse(one_from_two);
    const double range = std::hypot(one_from_two.x, one_from_two.y);
    return align_robots({range + range_sigma_m * normal(), range + range_sigma_m * normal(),
                         std::atan2(one_from_two.y, one_from_two.x) + bearing_sigma_rad * normal(),
                         std::atan2(back.y, back.x) + bearing_sigma_rad * normal(), range_sigma_m,
                         range_sigma_m, bearing_sigma_rad, bearing_sigma_rad});
  }

  std::size_t true_duplicates() const {
    std::size_t count = 0;
    for (const int post : post_of_two)
      count += static_cast<std::size_t>(std::count(post_of_one.begin(), post_of_one.end(), post));
    return count;
  }
  bool is_true(const Fusion::Duplicate& pair) const {
    const auto second = static_cast<std::size_t>(pair.gone - one.next_id);
    return post_of_one[static_cast<std::size_t>(pair.kept)] == post_of_two[second];
  }
};

TEST(Fusion, FindsTheDuplicatesAndNoOthers) {
  std::size_t found = 0, true_ones = 0;
  for (std::uint32_t seed = 1; seed <= 30; ++seed) {
    TwoMaps maps(seed);
    const Fusion fusion = fuse(maps.one, 0, maps.two, 0, maps.meet());
    for (const Fusion::Duplicate& pair : fusion.duplicates)
      EXPECT_TRUE(maps.is_true(pair)) << "seed " << seed;
    found += fusion.duplicates.size();
    true_ones += maps.true_duplicates();
    EXPECT_EQ(fusion.state.features.size(),
              maps.one.features.size() + maps.two.features.size() - fusion.duplicates.size());
  }
  EXPECT_GT(true_ones, 300U);
  EXPECT_GE(static_cast<double>(found), 0.95 * static_cast<double>(true_ones));
}

TEST(Fusion, IsConsistentAndTellsTheSecondRobotFarBetterThanTheSightingDid) {
  double nees = 0, before = 0, after = 0;
  constexpr int seeds = 30;
  for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
    TwoMaps maps(seed);
    const RobotAlignment alignment = maps.meet();
    const FeatureState plain = aligned(maps.one, 0, maps.two, 0, alignment);
    const Fusion fusion = fuse(maps.one, 0, maps.two, 0, alignment);
    const Pose truth = ominus(maps.truth_two, maps.start_one);
    nees += pose_nees(fusion.state, 1, truth) / 3 / seeds;
    before += std::sqrt(pose_covariance(plain, 1)(2, 2)) / seeds;
    after += std::sqrt(pose_covariance(fusion.state, 1)(2, 2)) / seeds;
  }
  EXPECT_GT(nees, 0.7);
  EXPECT_LT(nees, 1.3);
  EXPECT_LT(after, 0.5 * before);
}

/// Posts a metre apart on a line and on one beside it: maps that fit one another as well a metre on.
FeatureState colonnade(int posts) {
  FeatureState state;
  add_robot(state, {}, Eigen::Matrix3d::Zero());
  for (int i = 0; i < posts; ++i)
    add_feature(
        state, 0,
        {point_feature({0.5 * (i - i % 2), i % 2 == 0 ? -2.0 : 2.0}), 1e-4 * LocalMatrix::Identity(2, 2)});
  return state;
}

TEST(Fusion, LookAlikesAreNoTwinsHoweverManyFit) {
  const FeatureState one = colonnade(80), two = colonnade(80);
  const RobotAlignment by_a_metre{{1, 0, 0}, Eigen::Vector3d(4, 0.01, 1e-4).asDiagonal()};
  const Fusion fusion = fuse(one, 0, two, 0, by_a_metre);
  EXPECT_TRUE(fusion.duplicates.empty());
  EXPECT_EQ(fusion.state.features.size(), 160U);
}

TEST(Fusion, ASearchThatHasUsedUpItsStepsTakesNothingMore) {
  TwoMaps maps(1);
  const RobotAlignment alignment = maps.meet();
  const std::size_t all = fuse(maps.one, 0, maps.two, 0, alignment).duplicates.size();
  std::size_t before = 0;
  for (const std::size_t steps : {0U, 1U, 2U, 3U, 2'000U}) {
    FusionOptions options;
    options.steps_per_feature = steps;
    const Fusion fusion = fuse(maps.one, 0, maps.two, 0, alignment, options);
    EXPECT_GE(fusion.duplicates.size(), before) << steps;
    EXPECT_EQ(fusion.came_to_end, steps == 2'000U) << steps;
    for (const Fusion::Duplicate& pair : fusion.duplicates) EXPECT_TRUE(maps.is_true(pair)) << steps;
    before = fusion.duplicates.size();
    EXPECT_TRUE(steps > 0 || before == 0);
  }
  EXPECT_EQ(before, all);
  FusionOptions short_of_steps;
  short_of_steps.association.max_steps = 3;
  EXPECT_TRUE(fuse(maps.one, 0, maps.two, 0, alignment, short_of_steps).duplicates.empty());
}

TEST(Fusion, MapsWithNothingInCommonAreOnlyAligned) {
  TwoMaps maps(1);
  for (FeatureInState& entry : maps.two.features) entry.feature.a += Eigen::Vector2d(0, 200);
  const Fusion fusion = fuse(maps.one, 0, maps.two, 0, maps.meet());
  EXPECT_TRUE(fusion.duplicates.empty());
  EXPECT_EQ(fusion.state.features.size(), maps.one.features.size() + maps.two.features.size());
}

TEST(Fusion, RobotsThatMetLongAgoAreFusedByTheirMarks) {
  TwoMaps maps(3);
  const RobotAlignment alignment = maps.meet();
  const Fusion then = fuse(maps.one, 0, maps.two, 0, alignment);
  FeatureState one = maps.one, two = maps.two;
  const PoseOwner mark_1{add_mark(one, 0), true}, mark_2{add_mark(two, 0), true};
  move_robot(one, 0, {7, 2, 1}, 0.01 * Eigen::Matrix3d::Identity());
  move_robot(two, 0, {-3, 4, 2}, 0.01 * Eigen::Matrix3d::Identity());
  const Fusion now = fuse(one, mark_1, two, mark_2, alignment);
  EXPECT_LT(wrapped_difference(now.one_from_two, then.one_from_two).norm(), 1e-6);
  ASSERT_EQ(now.duplicates.size(), then.duplicates.size());
  EXPECT_TRUE(is_sound(now.state));
  ASSERT_EQ(now.state.marks.size(), 2U);
  const RobotInState& kept = pose_in(now.state, mark_1);
  const RobotInState& other = pose_in(now.state, {mark_2.which + one.next_id, true});
  const auto covariance = [](const FeatureState& state, const RobotInState& at) {
    return state.covariance.block<3, 3>(at.offset, at.offset).eval();
  };
  EXPECT_LT(wrapped_difference(kept.map_from_robot, then.state.robots[0].map_from_robot).norm(), 1e-6);
  EXPECT_LT(wrapped_difference(other.map_from_robot, then.state.robots[1].map_from_robot).norm(), 1e-6);
  EXPECT_TRUE(covariance(now.state, kept).isApprox(pose_covariance(then.state, 0), 1e-3));
  EXPECT_TRUE(covariance(now.state, other).isApprox(pose_covariance(then.state, 1), 1e-3));
  const FeatureState all = aligned(one, 0, two, 0, alignment);
  EXPECT_EQ(all.marks.at(1).id, mark_2.which + one.next_id);
  EXPECT_TRUE(is_sound(all));
}

TEST(Fusion, AWallKnownInPartsByBothIsWhollyKnownAfterwards) {
  const auto map_of = [](bool end_a, bool end_b, double from, double to) {
    FilterOptions options;
    options.tentative.confirm_after = 1;
    FeatureFilter filter(options);
    filter.add_robot({}, Eigen::Matrix3d::Zero());
    const Feature wall = segment_feature({4, from}, {4, to}, end_a, end_b);
    filter.observe(0, std::vector{ObservedFeature{wall, 1e-4 * LocalMatrix::Identity(3, 3)}});
    return filter.state();
  };
  const FeatureState one = map_of(true, false, -2, 1), two = map_of(false, true, -1, 3);
  const RobotAlignment alignment{{0, 0, 0}, 1e-4 * Eigen::Matrix3d::Identity()};
  const Fusion fusion = fuse(one, 0, two, 0, alignment);
  ASSERT_EQ(fusion.state.features.size(), 1U);
  const Feature& wall = fusion.state.features[0].feature;
  EXPECT_EQ(dimension(wall), 4);
  EXPECT_NEAR(wall.a.y(), -2, 0.01);
  EXPECT_NEAR(wall.b.y(), 3, 0.01);
}

TEST(Fusion, AHundredMeetingsCountAsAHundredMeasurementsAndNoMore) {
  TwoMaps maps(1);
  FeatureFilter filter;
  filter.replace(aligned(maps.one, 0, maps.two, 0, maps.meet(0.1, 0.005)));
  const Pose between = ominus(maps.truth_two, maps.truth_one);
  const double range = std::hypot(between.x, between.y), bearing = std::atan2(between.y, between.x);
  // Information adds: the state's own about the offset of the two, and a hundred times the sighting's.
  const auto measurement = measure_robot(filter.state(), {0, 1, range, bearing, 0.1, 0.005});
  const Eigen::Matrix2d before = cross_covariance(filter.state().covariance, *measurement, *measurement);
  for (int meeting = 0; meeting < 100; ++meeting)
    ASSERT_TRUE(filter.observe_robot(
        {0, 1, range + 0.1 * maps.normal(), bearing + 0.005 * maps.normal(), 0.1, 0.005}));
  const auto again = measure_robot(filter.state(), {0, 1, range, bearing, 0.1, 0.005});
  const Eigen::Matrix2d after = cross_covariance(filter.state().covariance, *again, *again);
  const Eigen::Matrix2d expected = (before.inverse() + 100 * measurement->noise.inverse()).inverse();
  EXPECT_TRUE(after.isApprox(expected, 0.1)) << after << "\n" << expected;
}

TEST(Fusion, AfterAHundredMeetingsTheRobotsStillErrAsTheySay) {
  double nees = 0;
  constexpr int seeds = 30;
  for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
    TwoMaps maps(seed);
    FeatureFilter filter;
    filter.replace(fuse(maps.one, 0, maps.two, 0, maps.meet()).state);
    for (int meeting = 0; meeting < 100; ++meeting) {
      const int observer = meeting % 2;
      const Pose seen =
          observer == 0 ? ominus(maps.truth_two, maps.truth_one) : ominus(maps.truth_one, maps.truth_two);
      filter.observe_robot({observer, 1 - observer, std::hypot(seen.x, seen.y) + 0.02 * maps.normal(),
                            std::atan2(seen.y, seen.x) + 0.07 * maps.normal(), 0.02, 0.07});
    }
    nees += pose_nees(filter.state(), 1, ominus(maps.truth_two, maps.start_one)) / 3 / seeds;
  }
  EXPECT_GT(nees, 0.7);
  EXPECT_LT(nees, 1.3);
}

/// Indices of features of the same posts, nearest to a place of the first map first.
std::vector<TwinSeed> posts_of_both(const TwoMaps& maps, const Eigen::Vector2d& about) {
  std::vector<TwinSeed> twins;
  for (std::size_t i = 0; i < maps.one.features.size(); ++i)
    for (std::size_t k = 0; k < maps.two.features.size(); ++k)
      if (maps.post_of_one[static_cast<std::size_t>(maps.one.features[i].id)] ==
          maps.post_of_two[static_cast<std::size_t>(maps.two.features[k].id)])
        twins.push_back({i, k});
  std::sort(twins.begin(), twins.end(), [&](const TwinSeed& a, const TwinSeed& b) {
    return (maps.one.features[a.one].feature.a - about).norm() <
           (maps.one.features[b.one].feature.a - about).norm();
  });
  return twins;
}

TEST(Fusion, BeginsWithTwinsInsteadOfARendezvous) {
  std::size_t found = 0, true_ones = 0;
  double nees = 0;
  for (std::uint32_t seed = 1; seed <= 30; ++seed) {
    TwoMaps maps(seed);
    const std::vector<TwinSeed> seeds = posts_of_both(maps, position(ominus(maps.truth_one, maps.start_one)));
    ASSERT_GT(seeds.size(), 4U);
    const Pose about = ominus(maps.start_two, maps.start_one) * Pose{0.2, -0.1, 0.02};
    const auto fusion = fuse(maps.one, maps.two, about, std::span(seeds).first(4));
    ASSERT_TRUE(fusion);
    for (const Fusion::Duplicate& pair : fusion->duplicates)
      EXPECT_TRUE(maps.is_true(pair)) << "seed " << seed;
    found += fusion->duplicates.size();
    true_ones += maps.true_duplicates();
    nees += pose_nees(fusion->state, 1, ominus(maps.truth_two, maps.start_one)) / 3 / 30;
    const Pose placed = fusion->one_from_two * maps.two.robots[0].map_from_robot;
    EXPECT_LT((position(placed) - position(fusion->state.robots[1].map_from_robot)).norm(), 1);
  }
  EXPECT_GE(static_cast<double>(found), 0.95 * static_cast<double>(true_ones));
  EXPECT_LT(nees, 1.5);
}

TEST(Fusion, AFalseTwinAmongThoseItBeginsWithGoes) {
  TwoMaps maps(1);
  std::vector<TwinSeed> seeds = posts_of_both(maps, position(ominus(maps.truth_one, maps.start_one)));
  ASSERT_GT(seeds.size(), 6U);
  seeds.resize(6);
  std::swap(seeds[4].two, seeds[5].two);
  const auto fusion = fuse(maps.one, maps.two, ominus(maps.start_two, maps.start_one), seeds);
  ASSERT_TRUE(fusion);
  for (const Fusion::Duplicate& pair : fusion->duplicates) EXPECT_TRUE(maps.is_true(pair));
}

TEST(Fusion, TwinsThatDetermineNoPlaceMakeNoOneMap) {
  TwoMaps maps(1);
  const std::vector<TwinSeed> seeds = posts_of_both(maps, {});
  const Pose about = ominus(maps.start_two, maps.start_one);
  EXPECT_FALSE(fuse(maps.one, maps.two, about, {}));
  EXPECT_FALSE(fuse(maps.one, maps.two, about, std::span(seeds).first(1)));
}

}  // namespace
}  // namespace isthmus
