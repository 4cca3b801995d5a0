#include "server/engine/places/consistency.hpp"

#include <gtest/gtest.h>

#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

constexpr Agreement yes = Agreement::consistent;
constexpr Agreement no = Agreement::inconsistent;
constexpr Agreement unrelated = Agreement::unrelated;

Relation odometry(int a, int b, const Pose& a_from_b) {
  Relation relation;
  relation.a = PatchId{a};
  relation.b = PatchId{b};
  relation.kind = RelationKind::odometry;
  relation.measurement = RelativePose{a_from_b, Eigen::Vector3d(1e4, 1e4, 1e6).asDiagonal()};
  relation.origin = {OriginKind::odometry, {}};
  return relation;
}

// Two pieces of way on islands of their own, each of three patches a metre apart:
//
//     0 -- 1 -- 2        3 -- 4 -- 5
Map two_ways() {
  Map map;
  for (int i = 0; i < 6; ++i)
    map.add(patch_from(furnished_room(), PatchId{i}, {}), {i < 3 ? 1.0 * i : 100 + 1.0 * i, 0, 0});
  for (const int a : {0, 1, 3, 4}) map.relate(odometry(a, a + 1, {1, 0, 0}));
  return map;
}

Find found(int query, int anchor, const Pose& anchor_from_query) {
  return {PatchId{query}, PatchId{anchor}, anchor_from_query, 0, 0, {}};
}

Agreement between(const Map& map, const Find& first, const Find& second) {
  return agreement(map, first, NearbyConfidence(map, first.anchor, 50),
                   NearbyConfidence(map, first.query, 50), second, {});
}

TEST(Agreement, FindsThatCloseTheLoopAroundThemAreConsistent) {
  const Map map = two_ways();
  EXPECT_EQ(between(map, found(3, 0, {0.5, 0, 0}), found(5, 2, {0.55, 0.05, 0.01})), yes);
}

TEST(Agreement, AFindAMetreOffIsInconsistent) {
  const Map map = two_ways();
  EXPECT_EQ(between(map, found(3, 0, {0.5, 0, 0}), found(5, 2, {1.6, 0, 0})), no);
  EXPECT_EQ(between(map, found(3, 0, {0.5, 0, 0}), found(5, 2, {0.5, 0, 0.3})), no);
}

// Of two finds at one place, of which each is known to 0.024 rad and 0.12 m, the map between them exactly.
TEST(Agreement, AsksForTheYawAndThePlaceByThemselves) {
  const Map map = two_ways();
  const auto turned_by = [&](double yaw) { return between(map, found(3, 0, {}), found(3, 0, {0, 0, yaw})); };
  EXPECT_EQ(turned_by(0.092), yes) << "one of a thousand is off by 0.0935 rad";
  EXPECT_EQ(turned_by(-0.092), yes);
  EXPECT_EQ(turned_by(0.095), no);
  EXPECT_EQ(turned_by(-0.095), no);
  const auto moved_by = [&](double y) { return between(map, found(3, 0, {}), found(3, 0, {0, y, 0})); };
  EXPECT_EQ(moved_by(0.55), yes) << "and by 0.558 m";
  EXPECT_EQ(moved_by(0.57), no);
}

// However little the map knows: 1 m and 0.167 rad are another place.
TEST(Agreement, HasBoundsThatNoUncertaintyWidens) {
  Map map;
  for (int i = 0; i < 4; ++i)
    map.add(patch_from(furnished_room(), PatchId{i}, {}), {i < 2 ? 1.0 * i : 100 + 1.0 * i, 0, 0});
  for (const int a : {0, 2}) {
    Relation loose = odometry(a, a + 1, {1, 0, 0});
    loose.measurement = RelativePose{{1, 0, 0}, Eigen::Vector3d(1, 1, 10).asDiagonal()};
    map.relate(loose);
  }
  const auto off_by = [&](const Pose& off) { return between(map, found(2, 0, {}), found(3, 1, off)); };
  EXPECT_EQ(off_by({}), yes);
  EXPECT_EQ(off_by({0, 0.95, 0}), yes);
  EXPECT_EQ(off_by({0, 1.05, 0}), no);
  EXPECT_EQ(off_by({0, 0, 0.16}), yes);
  EXPECT_EQ(off_by({0, 0, 0.17}), no);
}

TEST(Agreement, AFindFromTheOtherSideIsReadBackwards) {
  const Map map = two_ways();
  EXPECT_EQ(between(map, found(3, 0, {0.5, 0, 0.2}), found(0, 3, inverse({0.5, 0, 0.2}))), yes);
  EXPECT_EQ(between(map, found(3, 0, {0.5, 0, 0.2}), found(0, 3, {0.5, 0, 0.2})), no);
}

TEST(Agreement, FindsOfOtherIslandsAreUnrelated) {
  Map map = two_ways();
  map.add(patch_from(furnished_room(), PatchId{6}, {}), {});
  EXPECT_EQ(between(map, found(3, 0, {}), found(6, 1, {})), unrelated);
}

TEST(AgreementTable, FindsTheLargestSetThatHoldsAMember) {
  AgreementTable table;
  table.add({});
  table.add({yes});
  table.add({no, no});
  table.add({yes, yes, no});
  table.add({no, no, yes, unrelated});
  EXPECT_EQ(table.largest_consistent_with(0, {}), (std::vector<std::size_t>{0, 1, 3}));
  EXPECT_EQ(table.largest_consistent_with(4, {}), (std::vector<std::size_t>{2, 4}));
  EXPECT_EQ(table.rivals_of({0, 1, 3}), (std::vector<std::size_t>{2, 4}));
}

// What the map says nothing of speaks neither for nor against.
TEST(AgreementTable, CountsAsRivalsOnlyWhatContradictsMostOfASet) {
  AgreementTable table;
  table.add({});
  table.add({yes});
  table.add({yes, yes});
  table.add({unrelated, unrelated, unrelated});
  table.add({no, unrelated, unrelated});
  table.add({no, no, unrelated});
  EXPECT_EQ(table.rivals_of({0, 1, 2}), (std::vector<std::size_t>{5}));
}

TEST(AgreementTable, TakesAMemberForAnother) {
  AgreementTable table;
  table.add({});
  table.add({no});
  table.add({yes, yes});
  table.replace(1, {yes, no, no});
  EXPECT_EQ(table.size(), 3U);
  EXPECT_EQ(table.between(0, 1), yes);
  EXPECT_EQ(table.between(2, 1), no);
  EXPECT_EQ(table.between(2, 0), yes);
  EXPECT_EQ(table.largest_consistent_with(1, {}), (std::vector<std::size_t>{0, 1}));
}

TEST(AgreementTable, ClosesUpWhereMembersLeave) {
  AgreementTable table;
  table.add({});
  table.add({no});
  table.add({yes, no});
  table.add({yes, no, yes});
  table.remove({false, true, false, false});
  EXPECT_EQ(table.size(), 3U);
  EXPECT_EQ(table.largest_consistent_with(0, {}), (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_TRUE(table.rivals_of({0, 1, 2}).empty());
}

}  // namespace
}  // namespace isthmus
