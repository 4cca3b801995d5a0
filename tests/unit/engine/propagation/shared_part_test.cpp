#include "server/engine/propagation/shared_part.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/ways.hpp"
#include "tests/unit/relations/small_maps.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// Patches at given places of the map, each in a room of its own of the given size.
struct Placed {
  std::vector<PatchId> add(const std::vector<Eigen::Vector2d>& positions, double half_m = 2) {
    std::vector<PatchId> added;
    for (const Eigen::Vector2d& at : positions) {
      added.push_back(map.manifold().next_id());
      map.add(patch_from(box(half_m), added.back(), {}), {at.x(), at.y(), 0});
      island.push_back(added.back());
    }
    return added;
  }
  void relate_in_order(PatchId from, PatchId to) {
    for (int i = from.value; i < to.value; ++i) {
      const Pose step = map.relative_pose(PatchId{i}, PatchId{i + 1});
      map.relate(small_maps::relation(i, i + 1, RelativePose{step, Eigen::Matrix3d::Identity()}));
    }
  }
  SharedPart shared_from(PatchId second, const std::vector<PatchId>& matched) const {
    return shared_part(map, island, [&](PatchId id) { return id >= second; }, matched, {});
  }

  Map map;
  std::vector<PatchId> island;
};

std::vector<Eigen::Vector2d> row(int from, int to, double y = 0) {
  std::vector<Eigen::Vector2d> positions;
  for (int x = from; x <= to; ++x) positions.emplace_back(x, y);
  return positions;
}

TEST(SharedPartWay, CountsAMetreOnceHoweverOftenItWasDriven) {
  Placed placed;
  const std::vector<PatchId> first = placed.add({{0, 0}, {0.5, 0}, {1, 0}, {1.1, 0.2}, {2, 0}});
  const std::vector<PatchId> second = placed.add({{0, 0.1}, {1, 0.1}});
  std::vector<PatchId> matched = first;
  matched.insert(matched.end(), second.begin(), second.end());
  EXPECT_EQ(way_m(placed.map, matched, {}), 3);
}

// Two ways over the same ground, of which one is matched up to x = 3.
TEST(SharedPartWay, IsUnmatchedWhereNothingBesideMatchesOnTheSameWay) {
  Placed placed;
  const std::vector<PatchId> first = placed.add(row(0, 8)), second = placed.add(row(0, 8, 0.2));
  placed.relate_in_order(first.front(), first.back());
  placed.relate_in_order(second.front(), second.back());
  std::vector<PatchId> matched = first;
  matched.insert(matched.end(), {second[0], second[1], second[3]});
  const RelationGraph& apart = placed.map.graph();
  const std::vector<PatchId> gap = {second[2]}, end(second.begin() + 4, second.end());
  EXPECT_EQ(unmatched_way_m(placed.map, apart, gap, matched, {}), 0);
  EXPECT_EQ(unmatched_way_m(placed.map, apart, end, matched, {}), 4) << "from 5 to 8";
  EXPECT_EQ(unmatched_way_m(placed.map, apart, first, matched, {}), 0);
}

// Twice the standard deviation across the length of the whole.
TEST(SharedPartWidth, IsAcrossTheLength) {
  Placed placed;
  EXPECT_NEAR(width_m(placed.map, placed.add({{0, 0}, {3, 3}, {5, 5}, {9, 9}})), 0, 1e-6);
  EXPECT_NEAR(width_m(placed.map, placed.add({{-5, -1}, {5, -1}, {-5, 1}, {5, 1}})), 2, 1e-9);
  EXPECT_NEAR(width_m(placed.map, placed.add({{-1, -5}, {-1, 5}, {1, -5}, {1, 5}})), 2, 1e-9);
  EXPECT_EQ(width_m(placed.map, placed.add({{3, 4}})), 0);
}

// Ten metres of the first, of which the second is within 4 m of the first seven.
TEST(SharedPartOverlap, IsOfPatchesOfEitherNearTheOthers) {
  Placed placed;
  const std::vector<PatchId> first = placed.add(row(0, 20));
  const std::vector<PatchId> second = placed.add(row(18, 40));
  const std::vector<PatchId> near = overlapping(placed.map, first, second, {});
  const double near_m = SurroundingsOptions{}.reach_m;
  for (const PatchId id : first)
    EXPECT_EQ(std::ranges::count(near, id), placed.map.manifold().pose(id).x > 18 - near_m ? 1 : 0);
  for (const PatchId id : second)
    EXPECT_EQ(std::ranges::count(near, id), placed.map.manifold().pose(id).x < 20 + near_m ? 1 : 0);
}

TEST(SharedPartOwnWay, IsNowhereNearTheOthers) {
  Placed placed;
  placed.add(row(0, 9));
  const std::vector<PatchId> second = placed.add(row(0, 3, 0.5));
  const SharedPart of_both = placed.shared_from(second.front(), second);
  EXPECT_EQ(of_both.own_first_m, 3);
  EXPECT_EQ(of_both.own_second_m, 0);
}

TEST(SharedPartOwnWay, IsOfEither) {
  Placed placed;
  placed.add(row(0, 3));
  const PatchId second = placed.add(row(0, 9, 0.5)).front();
  EXPECT_EQ(placed.shared_from(second, {}).own_first_m, 0);
  EXPECT_EQ(placed.shared_from(second, {}).own_second_m, 3);
}

TEST(SharedPartBorder, IsContradictedByWallsInFreeSpace) {
  Placed alike;
  alike.add({{0, 0}, {0, 0}});
  EXPECT_EQ(alike.shared_from(PatchId{1}, alike.island).border_contradiction, 0);
  Placed unlike;
  unlike.add({{0, 0}}, 2);
  unlike.add({{0, 0}}, 4);
  EXPECT_EQ(unlike.shared_from(PatchId{1}, unlike.island).border_contradiction, 1);
  Placed far;
  far.add({{0, 0}}, 2);
  far.add({{7, 0}}, 20);
  EXPECT_EQ(far.shared_from(PatchId{1}, far.island).border_contradiction, 0)
      << "where their views do not meet";
}

// Two ways side by side, matched at 0 m; those at the far end contradict one another. A bend of a hundredth
// lays a wall .5 m into free space within some tens of metres.
TEST(SharedPartBorder, IsOnlyWhereWhatMatchesHoldsTheTwoTogether) {
  for (const int length_m : {5, 100}) {
    Placed placed;
    std::vector<Eigen::Vector2d> way;
    for (int x = 0; x < length_m; x += 10) way.emplace_back(x, 0);
    placed.add(way);
    const PatchId first_end = placed.add({{length_m, 0}}, 2).front();
    const PatchId second = placed.add(way).front();
    const PatchId second_end = placed.add({{length_m, 0}}, 4).front();
    placed.relate_in_order(PatchId{0}, first_end);
    placed.relate_in_order(second, second_end);
    const SharedPart shared = placed.shared_from(second, {PatchId{0}, second});
    EXPECT_EQ(shared.border_contradiction > 0, length_m == 5) << length_m;
  }
}

// A tag or a robot without a laser sees no walls.
TEST(SharedPart, LeavesOutPatchesWithoutPoints) {
  Placed placed;
  placed.add(row(0, 3));
  auto blind = std::make_shared<Patch>();
  blind->id = placed.map.manifold().next_id();
  placed.map.add(blind, {50, 0, 0});
  placed.island.push_back(blind->id);
  EXPECT_EQ(placed.shared_from(blind->id, {}).own_second_m, 0);
  EXPECT_EQ(placed.shared_from(blind->id, {}).own_first_m, 4) << "nor does it hide what others saw";
}

}  // namespace
}  // namespace isthmus
