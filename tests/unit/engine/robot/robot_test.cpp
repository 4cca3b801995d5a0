#include "server/engine/robot/robot.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace isthmus {
namespace {

// Of the first step its own noise, and its yaw's over the second; of the second its own, turned.
TEST(OdometryPath, AddsUpStepsAndWhatTheyErr) {
  OdometryPath path;
  path.append({1, 0, std::numbers::pi / 2}, Eigen::Vector3d(0.01, 0.01, 0.04).asDiagonal());
  path.append({1, 0, 0}, Eigen::Vector3d(0.02, 0.03, 0.05).asDiagonal());
  EXPECT_NEAR(path.start_from_end.x, 1, 1e-9);
  EXPECT_NEAR(path.start_from_end.y, 1, 1e-9);
  EXPECT_NEAR(path.start_from_end.yaw, std::numbers::pi / 2, 1e-9);
  EXPECT_NEAR(path.covariance(0, 0), 0.01 + 0.04 + 0.03, 1e-9);
  EXPECT_NEAR(path.covariance(1, 1), 0.01 + 0.02, 1e-9);
  EXPECT_NEAR(path.covariance(2, 2), 0.04 + 0.05, 1e-9);
  EXPECT_NEAR(path.covariance(0, 2), -0.04, 1e-9) << "a yaw to the left puts the end to the left";
}

TEST(OdometryPath, GoesOnAsItIsTurned) {
  OdometryPath path;
  path.append({1, 0, 2}, Eigen::Vector3d(0.01, 0.01, 0.04).asDiagonal());
  path.face(0.5, 0.001);
  EXPECT_EQ(path.start_from_end.yaw, 0.5);
  EXPECT_TRUE(path.covariance.isApprox(Eigen::Matrix3d(Eigen::Vector3d(0.01, 0.01, 0.001).asDiagonal())));
  path.append({1, 0, 0}, Eigen::Matrix3d::Zero());
  EXPECT_NEAR(path.start_from_end.x, 1 + std::cos(0.5), 1e-9);
  EXPECT_NEAR(path.start_from_end.y, std::sin(0.5), 1e-9);
}

TEST(OdometryPath, OfNoStepsIsSure) {
  EXPECT_EQ(OdometryPath{}.start_from_end, Pose{});
  EXPECT_EQ(OdometryPath{}.covariance, Eigen::Matrix3d::Zero());
}

}  // namespace
}  // namespace isthmus
