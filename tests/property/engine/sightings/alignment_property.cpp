#include "server/engine/sightings/alignment.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace isthmus {
namespace {

/// Two robots that drive about and see one another now and then: their islands are true, and lie anyhow.
class Meeting {
 public:
  Meeting(std::uint32_t seed, int count) : random_(seed) {
    first_from_second = {uniform(-20, 20), uniform(-20, 20), uniform(-std::numbers::pi, std::numbers::pi)};
    for (int i = 0; i < count; ++i) {
      const Pose first_from_robot1{uniform(-3, 3), uniform(-3, 3), uniform(-3, 3)};
      const Pose robot1_from_robot2{uniform(1, 4), uniform(-4, 4), uniform(-3, 3)};
      const Pose second_from_robot2 = inverse(first_from_second) * first_from_robot1 * robot1_from_robot2;
      if (i % 2 == 0) {
        see(true, first_from_robot1, second_from_robot2, robot1_from_robot2);
      } else {
        see(false, second_from_robot2, first_from_robot1, inverse(robot1_from_robot2));
      }
    }
  }

  Pose first_from_second;
  std::vector<ProjectedSighting> sightings;

 private:
  static constexpr double range_sigma_m = 0.1;
  static constexpr double bearing_sigma_rad = 0.05;
  // What `chi_squared` allows for stamps, mounts and odometry.
  static constexpr double floor_m = 0.05;
  static constexpr double floor_rad = 0.03;

  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  double normal(double sigma) { return std::normal_distribution<double>(0, sigma)(random_); }

  // Noise as the model has it: of the measurement, of the observer's pose, of the target, and the floors.
  void see(bool observer_in_first, const Pose& observer, const Pose& target,
           const Pose& observer_from_target) {
    constexpr double observer_sigma_m = 0.08, observer_sigma_rad = 0.03, target_sigma_m = 0.06;
    ProjectedSighting s;
    s.observer_in_first = observer_in_first;
    s.plane_from_observer =
        observer * Pose{normal(observer_sigma_m), normal(observer_sigma_m), normal(observer_sigma_rad)};
    s.observer_covariance.diagonal() << observer_sigma_m * observer_sigma_m,
        observer_sigma_m * observer_sigma_m, observer_sigma_rad * observer_sigma_rad;
    const double target_sigma = std::hypot(target_sigma_m, floor_m);
    s.target = {target.x + normal(target_sigma), target.y + normal(target_sigma)};
    s.target_variance = target_sigma_m * target_sigma_m;
    s.range_m = std::hypot(observer_from_target.x, observer_from_target.y) + normal(range_sigma_m);
    s.range_sigma_m = range_sigma_m;
    s.bearing_rad = wrap_angle(std::atan2(observer_from_target.y, observer_from_target.x) +
                               normal(std::hypot(bearing_sigma_rad, floor_rad)));
    s.bearing_sigma_rad = bearing_sigma_rad;
    sightings.push_back(s);
  }

  std::mt19937 random_;
};

// Over many meetings the error is as large as the covariance says: for each degree of freedom the mean of its
// normalised square is one.
TEST(AlignmentProperty, ItsErrorIsAsLargeAsItsCovarianceSays) {
  constexpr int meetings = 400;
  double nees = 0;
  int within_95 = 0, found = 0;
  for (std::uint32_t seed = 0; seed < meetings; ++seed) {
    const Meeting meeting(seed, 4 + static_cast<int>(seed % 8));
    const auto alignment = best_alignment(meeting.sightings, {});
    if (!alignment) continue;
    ++found;
    const Eigen::Vector3d error = wrapped_difference(alignment->first_from_second, meeting.first_from_second);
    const double squared = error.dot(alignment->covariance.ldlt().solve(error));
    nees += squared / 3;
    within_95 += squared < 7.815 ? 1 : 0;
  }
  std::printf("alignment: %d of %d found, NEES %.2f, %.1f %% within 95 %%\n", found, meetings, nees / found,
              100.0 * within_95 / found);
  EXPECT_GT(found, 0.98 * meetings);
  EXPECT_GT(nees / found, 0.7);
  EXPECT_LT(nees / found, 1.4);
  EXPECT_GT(within_95, 0.9 * found);
}

TEST(AlignmentProperty, DoesNotDependOnWhereEitherIslandLies) {
  EXPECT_TRUE(rc::check([] {
    const Meeting meeting(*rc::gen::arbitrary<std::uint32_t>(), *rc::gen::inRange(4, 14));
    const auto number = [] { return *rc::gen::inRange(-3000, 3001) * 1e-3; };
    const Pose new_from_first{10 * number(), 10 * number(), number()};
    const Pose new_from_second{10 * number(), 10 * number(), number()};
    std::vector<ProjectedSighting> moved = meeting.sightings;
    for (ProjectedSighting& s : moved) {
      s.plane_from_observer =
          (s.observer_in_first ? new_from_first : new_from_second) * s.plane_from_observer;
      s.target = (s.observer_in_first ? new_from_second : new_from_first) * s.target;
    }
    const auto here = best_alignment(meeting.sightings, {});
    const auto there = best_alignment(moved, {});
    RC_ASSERT(here.has_value() == there.has_value());
    RC_PRE(here.has_value());
    RC_ASSERT(here->supporters == there->supporters);
    RC_ASSERT(here->two_way == there->two_way);
    RC_ASSERT(std::abs(here->baseline_m - there->baseline_m) < 1e-9);
    const Pose wanted = new_from_first * here->first_from_second * inverse(new_from_second);
    RC_ASSERT(wrapped_difference(there->first_from_second, wanted).norm() < 1e-5);
  }));
}

TEST(AlignmentProperty, SeenFromTheOtherIslandItIsTheInverse) {
  EXPECT_TRUE(rc::check([] {
    const Meeting meeting(*rc::gen::arbitrary<std::uint32_t>(), *rc::gen::inRange(4, 14));
    std::vector<ProjectedSighting> exchanged = meeting.sightings;
    for (ProjectedSighting& s : exchanged) s.observer_in_first = !s.observer_in_first;
    const auto here = best_alignment(meeting.sightings, {});
    const auto there = best_alignment(exchanged, {});
    RC_ASSERT(here.has_value() == there.has_value());
    RC_PRE(here.has_value());
    RC_PRE(here->supporters == there->supporters);  // one at the very limit may fall to either side
    RC_ASSERT(wrapped_difference(there->first_from_second, inverse(here->first_from_second)).norm() < 1e-5);
  }));
}

TEST(AlignmentProperty, AnyMixOfTrueAndFalseGivesAFiniteAnswerOrNone) {
  EXPECT_TRUE(rc::check([] {
    Meeting meeting(*rc::gen::arbitrary<std::uint32_t>(), *rc::gen::inRange(0, 14));
    for (ProjectedSighting& s : meeting.sightings) {
      if (*rc::gen::inRange(0, 3) > 0) continue;
      s.range_m = *rc::gen::inRange(0, 8000) * 1e-3;
      s.bearing_rad = *rc::gen::inRange(-3100, 3100) * 1e-3;
    }
    const auto alignment = best_alignment(meeting.sightings, {});
    if (!alignment) return;
    RC_ASSERT(alignment->supporters.size() >= 2);
    RC_ASSERT(alignment->supporters.size() <= meeting.sightings.size());
    RC_ASSERT(std::ranges::is_sorted(alignment->supporters));
    RC_ASSERT(is_finite(alignment->first_from_second));
    RC_ASSERT(alignment->covariance.allFinite());
    RC_ASSERT(alignment->covariance.diagonal().minCoeff() > 0);
  }));
}

}  // namespace
}  // namespace isthmus
