#include "scanmatch/match_relations.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

struct Matched {
  LocalMap map;
  std::vector<ScanPoint> points;
  Match match;
};

Matched matched(const Walls& walls, const std::vector<Pose>& views, const Pose& truth) {
  Matched result;
  result.map.reference = PatchId{0};
  for (std::size_t i = 0; i < views.size(); ++i) {
    result.map.patches.push_back(
        {patch_from(walls, PatchId{static_cast<std::int32_t>(i)}, views[i]), views[i]});
  }
  result.points = to_points(scan_from(walls, truth), laser_of(), {});
  result.match = match_scan(result.map, result.points, {truth, Eigen::Matrix3d::Identity()}, {});
  return result;
}

TEST(MatchRelations, EachPatchPairedWithEnoughBeamsGetsOneWhoseMinimumIsTheMatch) {
  const std::vector<Pose> views = {{-1, 0, 0.2}, {0.5, -1, 0.4}};
  const Pose truth{0.2, -0.4, 0.3};
  const Matched m = matched(furnished_room(), views, truth);
  const auto relations = match_relations(m.map, m.points, m.match, PatchId{7}, {}, {});
  ASSERT_EQ(relations.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(relations[k].a, PatchId{static_cast<std::int32_t>(k)});
    EXPECT_EQ(relations[k].b, PatchId{7});
    EXPECT_GE(count(relations[k]), 10);
    const Pose expected = ominus(truth, views[k]);
    const Pose found = minimiser(relations[k].measurement, expected);
    EXPECT_NEAR(found.x, expected.x, 0.02);
    EXPECT_NEAR(found.y, expected.y, 0.02);
    EXPECT_NEAR(found.yaw, expected.yaw, 0.005);
  }
}

// Where a sure prediction held the match 3 cm off, the relation says what the beams say.
TEST(MatchRelations, SayWhereTheLinesAreNotWhereTheMatchCameToRest) {
  const Pose truth{0.2, -0.4, 0.3};
  Matched m = matched(furnished_room(), {{-1, 0, 0.2}}, truth);
  m.match.local_from_robot = truth * Pose{0.03, -0.02, 0};
  const auto relations = match_relations(m.map, m.points, m.match, PatchId{7}, {}, {});
  ASSERT_EQ(relations.size(), 1U);
  const Pose expected = ominus(truth, Pose{-1, 0, 0.2});
  const Pose found = minimiser(relations[0].measurement, expected);
  EXPECT_NEAR(found.x, expected.x, 0.01);
  EXPECT_NEAR(found.y, expected.y, 0.01);
}

// As MatchScan.NoiseTurnsAMatchBetweenWallsAtUnlikeDistancesNoMoreOneWayThanTheOther.
TEST(MatchRelations, NoiseTurnsThemNoMoreOneWayThanTheOther) {
  constexpr int trials = 500;
  std::mt19937 engine(2);
  const Pose from{0, -0.4, 0}, to{0.2, -0.4, 0};
  double yaw_rad = 0;
  for (int trial = 0; trial < trials; ++trial) {
    const Scan before = with_noise(scan_from(corridor(), from), 0.03, engine);
    const auto points = to_points(with_noise(scan_from(corridor(), to), 0.03, engine), laser_of(), {});
    const LocalMap map{PatchId{0}, {{make_patch(PatchId{0}, "R1", before, laser_of(), {}), from}}};
    const Match match = match_scan(map, points, {to, Eigen::Matrix3d::Identity()}, {});
    const auto relations = match_relations(map, points, match, PatchId{7}, {}, {});
    ASSERT_EQ(relations.size(), 1U);
    yaw_rad += minimiser(relations[0].measurement, ominus(to, from)).yaw / trials;
  }
  EXPECT_NEAR(yaw_rad, 0, 3e-4);
}

TEST(MatchRelations, PatchesPairedWithFewBeamsGetNone) {
  const Matched m = matched(furnished_room(), {{-1, 0, 0.2}}, {0.2, -0.4, 0.3});
  MatchRelationOptions options;
  options.min_correspondences = 1000;
  EXPECT_TRUE(match_relations(m.map, m.points, m.match, PatchId{7}, {}, options).empty());
}

TEST(MatchRelations, ACorridorsRelationSaysNothingAlongIt) {
  const Matched m = matched(corridor(), {{0, 0, 0}}, {0.5, 0.1, 0.05});
  const auto relations = match_relations(m.map, m.points, m.match, PatchId{1}, {}, {});
  ASSERT_EQ(relations.size(), 1U);
  const Eigen::Matrix3d h = information(relations[0].measurement, {0.5, 0.1, 0.05});
  EXPECT_LT(h(0, 0), 1e-3 * h(1, 1));
}

TEST(MatchRelations, AFewBeamsAlongTheCorridorAreHardlyTrusted) {
  // A single door frame of the corridor, seen by few beams.
  Walls walls = corridor();
  add_box(walls, 3, 0.8, 3.1, 1);
  const Matched m = matched(walls, {{0, 0, 0}}, {0.5, 0.1, 0.05});
  ASSERT_TRUE(m.match.ok);
  Match trusting = m.match;
  trusting.direction_trust.setIdentity();
  const auto with = match_relations(m.map, m.points, m.match, PatchId{1}, {}, {});
  const auto without = match_relations(m.map, m.points, trusting, PatchId{1}, {}, {});
  ASSERT_FALSE(with.empty());
  EXPECT_LT(information(with[0].measurement, {0.5, 0.1, 0.05})(0, 0),
            0.5 * information(without[0].measurement, {0.5, 0.1, 0.05})(0, 0));
}

// However little they are trusted, they say that the patch is where they are, and not beyond.
TEST(MatchRelations, OfAFewBeamsAlongTheCorridorAreAtTheirLeastWhereTheBeamsAre) {
  Walls walls = corridor();
  add_box(walls, 3, 0.65, 3.1, 1);
  const Pose truth{0.5, 0.1, 0.05};
  Matched m = matched(walls, {{0, 0, 0}}, truth);
  ASSERT_LT(m.match.direction_trust(0, 0), 0.7);
  m.match.local_from_robot.x += 0.05;
  const auto relations = match_relations(m.map, m.points, m.match, PatchId{1}, {}, {});
  ASSERT_EQ(relations.size(), 1U);
  EXPECT_NEAR(minimiser(relations[0].measurement, truth).x, truth.x, 0.02);
}

}  // namespace
}  // namespace isthmus
