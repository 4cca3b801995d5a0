#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <Eigen/Cholesky>

#include "scanmatch/features/scan_features.hpp"
#include "tests/property/drawn.hpp"
#include "tests/support/noisy_scan.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

ScanFeatureOptions options_of(const NoisyLaser& laser) {
  ScanFeatureOptions options;
  options.noise = {laser.range_sigma_m, laser.bearing_sigma_rad, 0};
  return options;
}

/// The wall that a segment was seen of, as the robot sees it: the one nearest to both of its ends.
Feature true_wall(const Walls& walls, const Pose& world_from_robot, const Feature& seen) {
  Feature nearest;
  double least = 1e9;
  for (const auto& [from, to] : walls) {
    Feature wall = inverse(world_from_robot) * segment_feature(from, to, true, true);
    if (across(wall).dot(wall.a) < 0) std::swap(wall.a, wall.b);
    const auto off = [&](const Eigen::Vector2d& end) {
      const double s = std::clamp(along(wall).dot(end - wall.a), 0.0, length_m(wall));
      return (wall.a + s * along(wall) - end).norm();
    };
    const double distance = off(seen.a) + off(seen.b);
    if (distance < least) {
      least = distance;
      nearest = wall;
    }
  }
  return nearest;
}

struct Nees {
  double line = 0, corners = 0, edges = 0;
  int lines = 0, corner_count = 0, edge_count = 0;

  void add(const ScanSegment& segment, const Feature& truth) {
    const ObservedFeature& seen = segment.observed;
    const LocalVector error =
        local_difference(FeatureKind::segment, local_coordinates(seen.feature, seen.feature),
                         local_coordinates(seen.feature, truth));
    const Eigen::Matrix2d covariance = seen.covariance.topLeftCorner<2, 2>();
    line += error.head<2>().dot(covariance.llt().solve(error.head<2>()));
    ++lines;
    const std::array<bool, 4> known = known_components(seen.feature);
    Eigen::Index row = 2;
    for (int k = 2; k < 4; ++k) {
      if (!known[static_cast<std::size_t>(k)]) continue;
      const bool corner = (k == 2 ? segment.end_a : segment.end_b) == EndKind::corner;
      (corner ? corners : edges) += error(k) * error(k) / seen.covariance(row, row);
      ++(corner ? corner_count : edge_count);
      ++row;
    }
  }
};

TEST(ScanFeaturesProperty, LinesErrAsMuchAsTheirCovarianceSays) {
  Walls walls;
  add_box(walls, -6, -4, 6, 4);
  add_box(walls, 1, 1, 2.5, 2.2);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> x(-4.5, 0), y(-3, 3), yaw(-3, 3);
  for (const int beams : {91, 181, 721}) {
    NoisyLaser laser;
    laser.beams = beams;
    laser.range_sigma_m = laser.bearing_sigma_rad = 0.003;
    Nees nees;
    for (int draw = 0; draw < 1500; ++draw) {
      const Pose pose{x(random), y(random), yaw(random)};
      for (const ScanSegment& s :
           find_features(laser.scan(walls, pose, random), laser.laser(), options_of(laser)).segments)
        nees.add(s, true_wall(walls, pose, s.observed.feature));
    }
    EXPECT_GT(nees.lines, 3000);
    EXPECT_GT(nees.line / (2 * nees.lines), 0.85) << beams << " beams";
    EXPECT_LT(nees.line / (2 * nees.lines), 1.15) << beams << " beams";
    EXPECT_GT(nees.corner_count, 3000);
    EXPECT_LT(nees.corners / nees.corner_count, 1)
        << beams << " beams";  // made larger, for they are not independent
    EXPECT_GT(nees.edge_count, 1000);
    EXPECT_GT(nees.edges / nees.edge_count, 0.7) << beams << " beams";
    EXPECT_LT(nees.edges / nees.edge_count, 1.8) << beams << " beams";
  }
}

TEST(ScanFeaturesProperty, ALaserMountedTurnedSeesTheSameFeaturesTurned) {
  EXPECT_TRUE(rc::check([] {
    std::mt19937 random(*rc::gen::arbitrary<std::uint32_t>());
    NoisyLaser laser;
    laser.range_sigma_m = laser.bearing_sigma_rad = 0.003;
    Walls walls = furnished_room();
    add_pillar(walls, {1, -2}, 0.2);
    const Scan scan = laser.scan(walls, {between(-1, 0), between(-1, 0.5), between(-3, 3)}, random);
    Laser turned = laser.laser();
    turned.robot_from_laser = {between(-0.3, 0.3), between(-0.3, 0.3), between(-3, 3)};
    const ScanFeatures plain = find_features(scan, laser.laser(), options_of(laser));
    const ScanFeatures moved = find_features(scan, turned, options_of(laser));
    RC_ASSERT(plain.segments.size() == moved.segments.size());
    for (std::size_t i = 0; i < plain.segments.size(); ++i) {
      const ObservedFeature &one = plain.segments[i].observed, &other = moved.segments[i].observed;
      RC_ASSERT(other.feature.a.isApprox((turned.robot_from_laser * one.feature).a, 1e-9));
      RC_ASSERT(other.covariance.isApprox(one.covariance, 1e-9));
    }
    RC_ASSERT(plain.poles.size() == moved.poles.size());
    for (std::size_t i = 0; i < plain.poles.size(); ++i)
      RC_ASSERT(std::abs(plain.poles[i].covariance.determinant() / moved.poles[i].covariance.determinant() -
                         1) < 1e-6);
  }));
}

TEST(ScanFeaturesProperty, AnyScanIsSurvivedAndEveryFeatureIsSound) {
  EXPECT_TRUE(rc::check([] {
    std::mt19937 random(*rc::gen::arbitrary<std::uint32_t>());
    NoisyLaser laser;
    laser.beams = *rc::gen::inRange(2, 400);
    laser.view_rad = between(0.1, 6.28);
    Scan scan = laser.scan(furnished_room(), {}, random);
    const float values[] = {
        0, -1, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1e-3F, 1e30F};
    for (float& range : scan.ranges_m)
      if (*rc::gen::inRange(0, 4) == 0) range = values[*rc::gen::inRange(0, 6)];
    const ScanFeatures features = find_features(scan, laser.laser(), {});
    for (const ScanSegment& s : features.segments) RC_ASSERT(is_sound(s.observed));
    for (const ObservedFeature& c : features.corners) RC_ASSERT(is_sound(c));
    for (const ObservedFeature& p : features.poles) RC_ASSERT(is_sound(p));
  }));
}

}  // namespace
}  // namespace isthmus
