#include "server/engine/map/surroundings.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// A relation of unmeasured kinds may say anything; here it says `sigma_m` and `sigma_rad`.
Relation tie(int a, int b, const Pose& a_from_b, RelationKind kind, double sigma_m, double sigma_rad) {
  const double by_m = 1 / (sigma_m * sigma_m);
  Relation relation =
      odometry_relation(PatchId{a}, PatchId{b}, a_from_b, {by_m, by_m, 1 / (sigma_rad * sigma_rad)});
  relation.kind = kind;
  return relation;
}

// All at one place of a room, so that any of them shows what a scan from there sees:
//
//     0 ---- 1 ---- 2 ---- 3
Map chain_of(RelationKind kind, double sigma_m, double sigma_rad) {
  Map map;
  for (int i = 0; i < 4; ++i) {
    map.add(patch_from(furnished_room(), PatchId{i}, {}), {});
    if (i > 0) map.relate(tie(i - 1, i, {}, kind, sigma_m, sigma_rad));
  }
  return map;
}

std::vector<int> those(const Surroundings& surroundings, bool Determined::*which) {
  std::vector<int> ids;
  for (const Determined& determined : surroundings.patches())
    if (determined.*which) ids.push_back(determined.patch.value);
  std::ranges::sort(ids);
  return ids;
}

std::vector<int> in_local_map(const Map& map, const Surroundings& surroundings) {
  std::vector<int> ids;
  for (const LocalPatch& local :
       surroundings.local_map(map, {}, map.manifold().patch(PatchId{0}).points, {}).patches)
    ids.push_back(local.patch->id.value);
  return ids;
}

const std::vector<int> nobody_else = {0};
const std::vector<int> all_four = {0, 1, 2, 3};

// Eq. 12 asks for 0.25 m at 95 %: σ of 0.09 m a step is that for two steps and no more.
TEST(Surroundings, AreWellDeterminedOnlyWhereEquation12Holds) {
  const Map map = chain_of(RelationKind::odometry, 0.085, 0.005);
  Surroundings surroundings;
  surroundings.update(map, PatchId{0}, {}, Surroundings::By::scans);
  EXPECT_EQ(surroundings.patches().size(), 4U)
      << "a local loop may close wherever local loops are looked for";
  EXPECT_EQ(those(surroundings, &Determined::well_determined), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(in_local_map(map, surroundings), (std::vector<int>{0, 1, 2}));
}

TEST(Surroundings, AreWellDeterminedOnlyWhereTheYawIsDeterminedToo) {
  const Map map = chain_of(RelationKind::odometry, 0.001, 0.09);
  Surroundings surroundings;
  surroundings.update(map, PatchId{0}, {}, Surroundings::By::scans);
  EXPECT_EQ(those(surroundings, &Determined::well_determined), (std::vector<int>{0, 1}));
}

// However sharp a sighting is: it says where robots are, not where walls are.
TEST(Surroundings, OfSightingsAreDeterminedByAllRelationsOnly) {
  for (const RelationKind kind : {RelationKind::range_bearing, RelationKind::range, RelationKind::bearing,
                                  RelationKind::relative_pose}) {
    const Map map = chain_of(kind, 0.01, 0.005);
    Surroundings surroundings;
    surroundings.update(map, PatchId{0}, {}, Surroundings::By::both);
    EXPECT_EQ(those(surroundings, &Determined::by_all_relations), all_four) << name(kind);
    EXPECT_EQ(those(surroundings, &Determined::well_determined), nobody_else) << name(kind);
    EXPECT_EQ(in_local_map(map, surroundings), nobody_else) << name(kind);
    surroundings.update(map, PatchId{0}, {}, Surroundings::By::scans);
    EXPECT_EQ(surroundings.patches().size(), 1U) << name(kind);
  }
}

TEST(Surroundings, OfScansAndOdometryAreWellDetermined) {
  for (const RelationKind kind : {RelationKind::odometry, RelationKind::point_to_line,
                                  RelationKind::point_to_point, RelationKind::line_to_line}) {
    const Map map = chain_of(kind, 0.01, 0.005);
    Surroundings surroundings;
    surroundings.update(map, PatchId{0}, {}, Surroundings::By::both);
    EXPECT_EQ(those(surroundings, &Determined::well_determined), all_four) << name(kind);
    EXPECT_EQ(in_local_map(map, surroundings), all_four) << name(kind);
  }
}

// A sighting beside scans that say little: the map is surer by it, but its walls are not.
TEST(Surroundings, ASightingMakesPoorlyKnownWallsNoBetterDetermined) {
  Map map = chain_of(RelationKind::odometry, 0.2, 0.02);
  map.relate(tie(0, 3, {}, RelationKind::range_bearing, 0.01, 0.005));
  Surroundings surroundings;
  surroundings.update(map, PatchId{0}, {}, Surroundings::By::both);
  EXPECT_EQ(those(surroundings, &Determined::by_all_relations), (std::vector<int>{0, 3}));
  EXPECT_EQ(those(surroundings, &Determined::well_determined), nobody_else);
}

TEST(Surroundings, ByAllRelationsAreAsByBothButForTheLocalMap) {
  Map map = chain_of(RelationKind::odometry, 0.05, 0.005);
  map.relate(tie(0, 3, {}, RelationKind::range_bearing, 0.01, 0.005));
  Surroundings by_all, by_both;
  by_all.update(map, PatchId{0}, {}, Surroundings::By::all);
  by_both.update(map, PatchId{0}, {}, Surroundings::By::both);
  ASSERT_EQ(by_all.patches().size(), by_both.patches().size());
  for (std::size_t i = 0; i < by_all.patches().size(); ++i)
    EXPECT_EQ(by_all.patches()[i].covariance, by_both.patches()[i].covariance);
  EXPECT_EQ(those(by_all, &Determined::by_all_relations), all_four);
  EXPECT_EQ(those(by_both, &Determined::well_determined), all_four);
  EXPECT_EQ(those(by_all, &Determined::well_determined), nobody_else) << "left open";
}

TEST(Surroundings, LookAgainOnlyWhereTheGraphNearChanged) {
  Map map = chain_of(RelationKind::odometry, 0.05, 0.005);
  map.add(patch_from(furnished_room(), PatchId{4}, {}), {});
  Surroundings surroundings;
  surroundings.update(map, PatchId{0}, {}, Surroundings::By::scans);
  const std::int64_t stamp = surroundings.stamp();
  map.add(patch_from(furnished_room(), PatchId{5}, {}), {});
  map.relate(tie(4, 5, {}, RelationKind::odometry, 0.1, 0.1));  // another island
  surroundings.update(map, PatchId{0}, {}, Surroundings::By::scans);
  EXPECT_EQ(surroundings.stamp(), stamp);
  map.relate(tie(3, 4, {}, RelationKind::odometry, 0.01, 0.005));
  surroundings.update(map, PatchId{0}, {}, Surroundings::By::scans);
  EXPECT_GT(surroundings.stamp(), stamp);
  EXPECT_EQ(surroundings.patches().size(), 6U);
}

// More patches than a local map takes: the oldest, and the newest.
TEST(Surroundings, GiveTheOldestAndTheNewestToTheLocalMap) {
  Map map;
  for (int i = 0; i < 20; ++i) {
    map.add(patch_from(furnished_room(), PatchId{i}, {}), {});
    if (i > 0) map.relate(tie(i - 1, i, {}, RelationKind::odometry, 0.01, 0.005));
  }
  Surroundings surroundings;
  surroundings.update(map, PatchId{10}, {}, Surroundings::By::scans);
  EXPECT_EQ(in_local_map(map, surroundings), (std::vector<int>{0, 1, 2, 3, 4, 5, 6, 7, 16, 17, 18, 19}));
}

TEST(Surroundings, LeaveOutOfTheLocalMapWhatTheScanDoesNotSee) {
  Map map = chain_of(RelationKind::odometry, 0.01, 0.005);
  const PatchId elsewhere = map.manifold().next_id();
  Walls other;
  add_box(other, -1, -1, 1, 1);
  map.add(patch_from(other, elsewhere, {}), {});
  map.relate(tie(0, elsewhere.value, {}, RelationKind::odometry, 0.01, 0.005));
  Surroundings surroundings;
  surroundings.update(map, PatchId{0}, {}, Surroundings::By::scans);
  EXPECT_EQ(those(surroundings, &Determined::well_determined).size(), 5U);
  EXPECT_EQ(in_local_map(map, surroundings), all_four);
}

// Whatever a scan from there sees; the farther and the poorly determined not.
TEST(Surroundings, NearestPatchesAreThoseWellDeterminedThere) {
  Map map;
  for (int i = 0; i < 20; ++i) {
    map.add(patch_from(furnished_room(), PatchId{i}, {}), {0.5 * i, 0, 0});
    if (i > 0) map.relate(tie(i - 1, i, {0.5, 0, 0}, RelationKind::odometry, 0.01, 0.005));
  }
  map.add(patch_from(furnished_room(), PatchId{20}, {}), {3, 0, 0});
  map.relate(tie(6, 20, {}, RelationKind::odometry, 1, 0.005));
  Surroundings surroundings;
  surroundings.update(map, PatchId{6}, {}, Surroundings::By::scans);
  SurroundingsOptions options;
  options.reach_m = 1.2;
  const auto nearest = [&] {
    std::vector<int> ids;
    for (const LocalPatch& local : surroundings.nearest_patches(map, {0.1, 0, 0}, options).patches)
      ids.push_back(local.patch->id.value);
    return ids;
  };
  EXPECT_EQ(nearest(), (std::vector<int>{6, 7, 5, 8, 4})) << "3.1 m along the line, nearest first";
  options.oldest = 2;
  options.newest = 1;
  EXPECT_EQ(nearest(), (std::vector<int>{6, 7, 5})) << "as many as a local map has";
}

}  // namespace
}  // namespace isthmus
