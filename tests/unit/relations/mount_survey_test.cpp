#include "relations/mount_survey.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace isthmus {
namespace {

constexpr MountSurvey survey{0.02, 0.03};

TEST(MountCovariance, OfParallelPosesAtOnePlaceOfOneRobotIsNone) {
  EXPECT_TRUE(mount_covariance({0, 0, 0}, "R1", "R1", survey).isZero(1e-15));
}

TEST(MountCovariance, TurnsWhatOneRobotSaysIsFarAway) {
  const Eigen::Matrix3d far = mount_covariance({10, 0, 0}, "R1", "R1", survey);
  EXPECT_NEAR(far(0, 0), 0, 1e-15);
  EXPECT_NEAR(far(1, 1), 100 * 9e-4, 1e-12) << "10 m times the sigma of the yaw";
  EXPECT_NEAR(far(2, 2), 0, 1e-15) << "both headings err alike";
}

TEST(MountCovariance, ShowsTwiceWhereTheRobotFacesTheOtherWay) {
  const Eigen::Matrix3d back = mount_covariance({0, 0, std::numbers::pi}, "R1", "R1", survey);
  EXPECT_NEAR(back(0, 0), 4 * 4e-4, 1e-12);
  EXPECT_NEAR(back(1, 1), 4 * 4e-4, 1e-12);
}

TEST(MountCovariance, OfTwoRobotsAddsUp) {
  const Eigen::Matrix3d two = mount_covariance({0, 0, 0}, "R1", "R2", survey);
  EXPECT_NEAR(two(0, 0), 2 * 4e-4, 1e-12);
  EXPECT_NEAR(two(2, 2), 2 * 9e-4, 1e-12);
}

TEST(MountCovariance, OfWhatNoRobotCarriesIsNone) {
  EXPECT_TRUE(mount_covariance({4, 2, 1}, "", "", survey).isZero(1e-15));
  const Eigen::Matrix3d tag = mount_covariance({4, 0, 1}, "R1", "", survey);
  EXPECT_NEAR(tag(0, 0), 4e-4, 1e-12);
  EXPECT_NEAR(tag(1, 1), 4e-4 + 16 * 9e-4, 1e-12);
}

TEST(MountCovariance, IsThatOfMountsDrawnAtRandom) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const Pose a_from_b{3, -2, 2.2};
  const auto mount = [&] {
    return Pose{survey.position_sigma_m * normal(random), survey.position_sigma_m * normal(random),
                survey.yaw_sigma_rad * normal(random)};
  };
  constexpr int draws = 40000;
  for (const bool one_robot : {true, false}) {
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (int i = 0; i < draws; ++i) {
      const Pose a = mount(), b = one_robot ? a : mount();
      const Eigen::Vector3d error = wrapped_difference(inverse(a) * a_from_b * b, a_from_b);
      sum += error * error.transpose() / draws;
    }
    const Eigen::Matrix3d told = mount_covariance(a_from_b, "R1", one_robot ? "R1" : "R2", survey);
    EXPECT_LT((sum - told).norm(), 0.03 * told.norm()) << sum << "\n\n" << told;
  }
}

}  // namespace
}  // namespace isthmus
