#include "scanmatch/score_profile.hpp"

#include <gtest/gtest.h>

#include "scanmatch/match_relations.hpp"
#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// |==u==u==u==u==u==u==|   Door frames every 0.5 m: a step to the next one fits as well but at the ends.
//       o->
// |==u==u==u==u==u==u==|
Walls ribbed_corridor(double depth_m = 0.1) {
  Walls walls = corridor();
  for (int i = -60; i <= 60; ++i) {
    add_box(walls, 0.5 * i, 1 - depth_m, 0.5 * i + 0.1, 1);
    add_box(walls, 0.5 * i, -1, 0.5 * i + 0.1, -1 + depth_m);
  }
  return walls;
}

struct Found {
  LocalMap map;
  std::vector<ScanPoint> points;
  Match match;
};

Found found_in(const Walls& walls) {
  Found found;
  found.map.patches.push_back({patch_from(walls, PatchId{0}, Pose{}), Pose{}});
  const Pose truth{0.3, 0.1, 0.05};
  found.points = to_points(scan_from(walls, truth), laser_of(), {});
  found.match = match_scan(found.map, found.points, {truth, Eigen::Matrix3d::Zero()}, {});
  return found;
}

double spread_in(const Found& found) {
  return sigma_along_weak_direction(found.map, found.points, found.match, 0.6, {}, {});
}

TEST(SigmaAlongWeakDirection, IsSmallWhereAStepAsideFitsWorse) {
  const Found found = found_in(furnished_room());
  ASSERT_TRUE(found.match.ok);
  EXPECT_LT(spread_in(found), 0.02);
}

TEST(SigmaAlongWeakDirection, ReachesOverAllThatFitsAsWell) {
  EXPECT_GT(spread_in(found_in(corridor())), 0.25) << "of at most 0.6 m either way";
  EXPECT_GT(spread_in(found_in(ribbed_corridor(0.05))), 0.2);
}

// What its relation says along and across the corridor, and of the yaw.
Eigen::Matrix3d said_by(const Found& found) {
  const auto relations = match_relations(found.map, found.points, found.match, PatchId{1}, {}, {});
  return relations.size() == 1 ? information(relations.front(), found.match.local_from_robot)
                               : Eigen::Matrix3d(Eigen::Matrix3d::Zero());
}

TEST(Widen, RelationsSayTheUncertaintyAlongAndWhatTheySaidAcross) {
  Found found = found_in(ribbed_corridor());
  const Eigen::Matrix3d before = said_by(found);
  const double weak_sigma_m = 0.3;
  widen(found.match, weak_sigma_m, relation_sigma_m(found.match.quality, {}), {});
  const Eigen::Matrix3d after = said_by(found);
  EXPECT_GT(before(0, 0), 10 / (weak_sigma_m * weak_sigma_m)) << "ribs look like certainty";
  EXPECT_LT(after(0, 0), 1.5 / (weak_sigma_m * weak_sigma_m));
  EXPECT_NEAR(after(1, 1), before(1, 1), 0.02 * before(1, 1));
  EXPECT_GT(after(2, 2), 0.5 * before(2, 2));
}

// One pillar in a corridor: few beams say how far along it the scan lies, and wherever else it is held it
// fits worse.
TEST(BelieveProfile, FewBeamsAreTrustedWhereTheScanFitsNowhereElse) {
  Walls walls = corridor();
  add_box(walls, 2, 0.5, 2.3, 0.8);
  Found found = found_in(walls);
  const Eigen::Vector3d little(0.02, 1, 1);  // as they would be among many more along the walls
  found.match.direction_trust = little.head<2>().asDiagonal() * found.match.direction_trust;
  found.match.beam_information = little.asDiagonal() * found.match.beam_information * little.asDiagonal();
  const double sigma_m = relation_sigma_m(found.match.quality, {}), weak_sigma_m = spread_in(found);
  ASSERT_LT(weak_sigma_m, 0.1);
  const Eigen::Matrix3d before = said_by(found);
  believe_profile(found.match, weak_sigma_m, sigma_m, {}, {});
  const Eigen::Matrix3d after = said_by(found);
  EXPECT_GT(after(0, 0), 1.5 * before(0, 0));
  EXPECT_NEAR(after(1, 1), before(1, 1), 0.02 * before(1, 1));
}

TEST(BelieveProfile, WidensWhereTheScanFitsAlongTheWholeWay) {
  Found found = found_in(ribbed_corridor()), widened = found;
  const double sigma_m = relation_sigma_m(found.match.quality, {}), weak_sigma_m = 0.3;
  widen(widened.match, weak_sigma_m, sigma_m, {});
  believe_profile(found.match, weak_sigma_m, sigma_m, {}, {});
  EXPECT_NEAR(said_by(found)(0, 0), said_by(widened)(0, 0), 0.1 * said_by(widened)(0, 0));
}

TEST(BelieveProfile, NothingIsSurerThanAllBeamsAre) {
  Walls walls = corridor();
  add_box(walls, 2, 0.5, 2.3, 0.8);
  Found found = found_in(walls);
  const double noise_m = 1;  // of a beam: far more than the profile's step
  believe_profile(found.match, spread_in(found), noise_m, {}, {});
  EXPECT_NEAR(found.match.direction_trust(0, 0), 1, 0.01);
}

}  // namespace
}  // namespace isthmus
