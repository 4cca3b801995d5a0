#include "server/engine/sightings/alignment.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "tests/support/poses.hpp"
#include "tests/support/unmeasured.hpp"

namespace isthmus {
namespace {

using testing::expect_near;
using testing::unmeasured;

const Pose first_from_second{3, -2, 1.1};

// What an observer at a place of its plane measures, exactly, of a target at a place of the other plane.
ProjectedSighting exact(bool observer_in_first, const Pose& plane_from_observer,
                        const Eigen::Vector2d& target) {
  ProjectedSighting s;
  s.observer_in_first = observer_in_first;
  s.plane_from_observer = plane_from_observer;
  s.target = target;
  const Pose chart_from_other = observer_in_first ? first_from_second : inverse(first_from_second);
  const Eigen::Vector2d seen = inverse(plane_from_observer) * (chart_from_other * target);
  s.range_m = seen.norm();
  s.bearing_rad = std::atan2(seen.y(), seen.x());
  s.range_sigma_m = 0.05;
  s.bearing_sigma_rad = 0.03;
  return s;
}

// The target's place in the second plane, from where it is in the first.
Eigen::Vector2d in_second(const Eigen::Vector2d& of_first) { return inverse(first_from_second) * of_first; }

ProjectedSighting range_only(ProjectedSighting s) {
  s.bearing_sigma_rad = unmeasured;
  return s;
}

ProjectedSighting bearing_only(ProjectedSighting s) {
  s.range_sigma_m = unmeasured;
  return s;
}

// Zhou and Roumeliotis (2006), eqs. 1-3: robots that see one another are turned by θ = π + ¹θ₂ − ²θ₁, where
// ¹θ₂ is the bearing of robot 2 as robot 1 has it.
//
//      R1 --- ¹θ₂ ------ range ------ ²θ₁ --- R2
TEST(Alignment, OfAMutualPairIsTheClosedFormOfItsBearingsAndRange) {
  const Pose first_from_robot1{1, 0.5, 0.4};
  const Pose second_from_robot2{-1.2, 3.1, -2.5};
  const std::vector<ProjectedSighting> pair{
      exact(true, first_from_robot1, {second_from_robot2.x, second_from_robot2.y}),
      exact(false, second_from_robot2, {first_from_robot1.x, first_from_robot1.y})};
  const double bearing = pair[0].bearing_rad;
  const Pose robot1_from_robot2{pair[0].range_m * std::cos(bearing), pair[0].range_m * std::sin(bearing),
                                wrap_angle(std::numbers::pi + bearing - pair[1].bearing_rad)};
  const Pose closed_form = first_from_robot1 * robot1_from_robot2 * inverse(second_from_robot2);
  expect_near(closed_form, first_from_second, 1e-12);

  const auto alignment = best_alignment(pair, {});
  ASSERT_TRUE(alignment);
  expect_near(alignment->first_from_second, closed_form, 1e-9);
  EXPECT_TRUE(alignment->two_way);
  EXPECT_EQ(alignment->supporters, (std::vector<std::size_t>{0, 1}));
  EXPECT_NEAR(alignment->baseline_m, pair[0].range_m, 1e-9);
}

TEST(Alignment, TakesTheDistanceOfAMutualPairBetweenWhatTheTwoMeasured) {
  const Pose first_from_robot1{1, 0.5, 0.4};
  const Pose second_from_robot2{-1.2, 3.1, -2.5};
  std::vector<ProjectedSighting> pair{
      exact(true, first_from_robot1, {second_from_robot2.x, second_from_robot2.y}),
      exact(false, second_from_robot2, {first_from_robot1.x, first_from_robot1.y})};
  const double truth_m = pair[0].range_m;
  pair[0].range_m += 0.03;
  pair[1].range_m -= 0.03;
  const auto alignment = best_alignment(pair, {});
  ASSERT_TRUE(alignment);
  const Pose there = alignment->first_from_second * second_from_robot2;
  const double between_m = std::hypot(there.x - first_from_robot1.x, there.y - first_from_robot1.y);
  EXPECT_NEAR(between_m, truth_m, 1e-6);
}

// One robot watches the other from two places, or the other moves:
//
//      A . . . . . . . . t1
//      B . . . . . . . . t2
TEST(Alignment, OneWaySightingsFromDifferentPlacesDetermineIt) {
  const std::vector<ProjectedSighting> sightings{exact(true, {0, 0, 0.3}, in_second({4, 0})),
                                                 exact(true, {1.5, 1, 0.9}, in_second({4, 2})),
                                                 exact(true, {0.2, 2, -0.4}, in_second({3, 4}))};
  const auto alignment = best_alignment(sightings, {});
  ASSERT_TRUE(alignment);
  expect_near(alignment->first_from_second, first_from_second, 1e-9);
  EXPECT_FALSE(alignment->two_way);
  EXPECT_EQ(alignment->supporters.size(), 3U);
  EXPECT_NEAR(alignment->baseline_m, std::hypot(1, 4), 1e-9);
}

TEST(Alignment, OneWaySightingsOfATargetThatStandsStillDetermineNothing) {
  const std::vector<ProjectedSighting> sightings{exact(true, {0, 0, 0.3}, in_second({4, 0})),
                                                 exact(true, {1.5, 1, 0.9}, in_second({4.1, 0.1})),
                                                 exact(true, {0.2, 2, -0.4}, in_second({3.9, 0}))};
  EXPECT_FALSE(best_alignment(sightings, {}));
}

TEST(Alignment, OneSightingOrNoneDetermineNothing) {
  EXPECT_FALSE(best_alignment({}, {}));
  const std::vector<ProjectedSighting> one{exact(true, {}, in_second({4, 0}))};
  EXPECT_FALSE(best_alignment(one, {}));
}

TEST(Alignment, OutliersDoNotSupportAndDoNotMoveIt) {
  std::vector<ProjectedSighting> sightings;
  for (int i = 0; i < 5; ++i) {
    sightings.push_back(exact(true, {0.5 * i, 0.2 * i, 0.1 * i}, in_second({4, 1.0 * i})));
    sightings.push_back(exact(false, {0.3 * i, 2, 0.4 * i}, {1, 0.5 * i}));
  }
  sightings[1].bearing_rad = wrap_angle(sightings[1].bearing_rad + 1.5);
  sightings[4].range_m += 2.5;
  sightings[6].target += Eigen::Vector2d(3, 3);
  const auto alignment = best_alignment(sightings, {});
  ASSERT_TRUE(alignment);
  EXPECT_EQ(alignment->supporters, (std::vector<std::size_t>{0, 2, 3, 5, 7, 8, 9}));
  expect_near(alignment->first_from_second, first_from_second, 1e-9);
  for (const std::size_t i : {1U, 4U, 6U})
    EXPECT_FALSE(agrees(sightings[i], alignment->first_from_second, {}));
}

TEST(Alignment, TwoThatContradictOneAnotherAreNoAlignment) {
  std::vector<ProjectedSighting> pair{
      exact(true, {0, 0, 0}, in_second({4, 0})),
      exact(false, {in_second({4, 0}).x(), in_second({4, 0}).y(), 0}, {0, 0})};
  ASSERT_TRUE(best_alignment(pair, {}));
  pair[1].range_m += 3;
  EXPECT_FALSE(best_alignment(pair, {}));
}

TEST(Alignment, RangesAloneAndBearingsAloneSupportButCannotBegin) {
  std::vector<ProjectedSighting> partial;
  for (int i = 0; i < 4; ++i) {
    const ProjectedSighting s = exact(i % 2 == 0, {0.7 * i, 0.3 * i, 0.2}, {4, 1.0 * i});
    partial.push_back(range_only(s));
    partial.push_back(bearing_only(s));
  }
  EXPECT_FALSE(best_alignment(partial, {}));

  partial.push_back(exact(true, {0, 0, 0}, in_second({4, 0})));
  partial.push_back(exact(true, {0, 0, 0}, in_second({4, 2})));
  const auto alignment = best_alignment(partial, {});
  ASSERT_TRUE(alignment);
  EXPECT_EQ(alignment->supporters.size(), partial.size());
  expect_near(alignment->first_from_second, first_from_second, 1e-9);

  partial[0].range_m += 2;        // a range that does not agree
  partial[3].bearing_rad += 0.7;  // nor does this bearing
  const auto without = best_alignment(partial, {});
  ASSERT_TRUE(without);
  EXPECT_EQ(without->supporters, (std::vector<std::size_t>{1, 2, 4, 5, 6, 7, 8, 9}));
}

TEST(Alignment, RefiningGoesToTheTruthFromAStartThatIsOff) {
  const std::vector<ProjectedSighting> sightings{exact(true, {0, 0, 0.3}, in_second({4, 0})),
                                                 exact(false, {1.5, 1, 0.9}, {-1, 2}),
                                                 exact(true, {0.2, 2, -0.4}, in_second({3, 4}))};
  const Alignment alignment = fit_alignment(
      sightings, {0, 1, 2}, to_pose(to_vector(first_from_second) + Eigen::Vector3d(0.3, -0.2, 0.2)), {});
  expect_near(alignment.first_from_second, first_from_second, 1e-7);
}

// With exact data the residuals vanish, so that the information JᵀJ is the curvature of half the chi². The
// information is compared with second differences: every column of the Jacobian is in it.
TEST(Alignment, CovarianceIsTheInverseOfTheCurvatureOfTheChiSquared) {
  std::vector<ProjectedSighting> whole, ranges, bearings;
  for (int i = 0; i < 4; ++i) {
    ProjectedSighting s = exact(i % 2 == 0, {0.7 * i, 0.5 * i * i, 0.6 * i}, {4 - 2.0 * i, 1.0 * i});
    s.observer_covariance = Eigen::Vector3d(0.01, 0.02, 0.003).asDiagonal();
    s.observer_covariance(0, 1) = s.observer_covariance(1, 0) = 0.005;
    s.target_variance = 0.01;
    whole.push_back(s);
    ranges.push_back(range_only(s));
    bearings.push_back(bearing_only(s));
  }
  for (const auto& sightings : {whole, ranges, bearings}) {
    const auto half = [&](const Eigen::Vector3d& step) {
      double sum = 0;
      for (const ProjectedSighting& s : sightings)
        sum += 0.5 * chi_squared(s, to_pose(to_vector(first_from_second) + step), {});
      return sum;
    };
    constexpr double h = 1e-4;
    Eigen::Matrix3d curvature;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const Eigen::Vector3d a = h * Eigen::Vector3d::Unit(i), b = h * Eigen::Vector3d::Unit(j);
        curvature(i, j) = (half(a + b) - half(a - b) - half(b - a) + half(-a - b)) / (4 * h * h);
      }
    const Alignment alignment = fit_alignment(sightings, {0, 1, 2, 3}, first_from_second, {});
    const Eigen::Matrix3d information = alignment.covariance.inverse();
    EXPECT_LT((information - curvature).norm(), 2e-3 * curvature.norm()) << information << "\n\n"
                                                                         << curvature;
  }
}

TEST(Alignment, WhatWasMeasuredIsWeighedWithBothPosesAndWhatClocksLeaveOpen) {
  ProjectedSighting s = exact(true, {0, 0, 0}, in_second({2, 0}));
  s.range_m += 0.3;
  s.range_sigma_m = 0.1;
  constexpr double floor = 0.05 * 0.05;  // m², of stamps, mounts and odometry
  EXPECT_NEAR(chi_squared(s, first_from_second, {}), 0.09 / (0.01 + floor), 1e-9);
  s.observer_covariance(0, 0) = 0.04;  // along the range
  s.observer_covariance(1, 1) = 0.5;   // across it
  EXPECT_NEAR(chi_squared(s, first_from_second, {}), 0.09 / (0.01 + floor + 0.04), 1e-9);
  s.target_variance = 0.05;
  EXPECT_NEAR(chi_squared(s, first_from_second, {}), 0.09 / (0.01 + floor + 0.04 + 0.05), 1e-9);
  EXPECT_TRUE(agrees(s, first_from_second, {}));
  s.range_m += 2;
  EXPECT_FALSE(agrees(s, first_from_second, {}));
}

TEST(Alignment, ABearingIsComparedAcrossTheTurnOfTheAngle) {
  ProjectedSighting s = exact(true, {0, 0, std::numbers::pi}, in_second({3, 0.001}));
  ASSERT_NEAR(std::abs(s.bearing_rad), std::numbers::pi, 1e-3);
  s.bearing_rad = wrap_angle(s.bearing_rad + 0.002);
  EXPECT_LT(chi_squared(s, first_from_second, {}), 0.01);
}

// Which of some sightings agree, and when they were; 1 s apart from the first on unless said otherwise.
struct Asked {
  Alignment alignment;
  std::vector<ProjectedSighting> sightings;

  Asked(int supporters, int others, bool two_way, double baseline_m = 2) {
    alignment.two_way = two_way;
    alignment.baseline_m = baseline_m;
    for (int i = 0; i < supporters; ++i) alignment.supporters.push_back(static_cast<std::size_t>(i));
    const int all = supporters + others;
    sightings.resize(static_cast<std::size_t>(all));
    for (std::size_t i = 0; i < sightings.size(); ++i) at(i, static_cast<double>(i));
  }
  void at(std::size_t i, double time_s) { sightings[i].utime = static_cast<std::int64_t>(1e6 * time_s); }
  bool ready(double now_s = 0, bool no_more_waiting = false) const {
    return isthmus::ready(alignment, sightings, static_cast<std::int64_t>(1e6 * now_s), no_more_waiting, {});
  }
};

TEST(Ready, IsAnAlignmentThatMoreSupportThanDisagreeWith) {
  EXPECT_TRUE(Asked(3, 0, true).ready());
  EXPECT_TRUE(Asked(3, 2, true).ready());
  EXPECT_FALSE(Asked(3, 3, true).ready());
  EXPECT_FALSE(Asked(3, 4, true).ready());
  EXPECT_FALSE(Asked(3, 3, true).ready(100, true)) << "not even at the end";
}

TEST(Ready, CountsAsRivalsOnlyThoseOfTheSameTime) {
  for (const double off_s : {-10.5, 12.5}) {
    Asked asked(3, 3, true);
    for (std::size_t i = 3; i < 6; ++i) asked.at(i, off_s);
    EXPECT_TRUE(asked.ready()) << off_s;
  }
  for (const double off_s : {-9.5, 11.5}) {
    Asked asked(3, 3, true);
    for (std::size_t i = 3; i < 6; ++i) asked.at(i, off_s);
    EXPECT_FALSE(asked.ready()) << off_s;
  }
}

TEST(Ready, IsALonePairOfEitherDirectionAfterThreeSecondsOrAtTheEnd) {
  const Asked pair(2, 0, true);  // the second is of 1 s
  EXPECT_FALSE(pair.ready(3.9));
  EXPECT_TRUE(pair.ready(4.1));
  EXPECT_TRUE(pair.ready(0, true));
}

TEST(Ready, AreThreeOfOneDirectionOnlyFromPlacesApart) {
  EXPECT_FALSE(Asked(2, 0, false).ready(100, true));
  EXPECT_FALSE(Asked(3, 0, false, 0.9).ready(100, true));
  EXPECT_TRUE(Asked(3, 0, false, 1.1).ready());
}
}  // namespace
}  // namespace isthmus
