#include "server/engine/propagation/shared_part.hpp"

#include <gtest/gtest.h>

#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

Walls box(double half_m) {
  Walls walls;
  add_box(walls, -half_m, -half_m, half_m, half_m);
  return walls;
}

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
  EXPECT_EQ(placed.shared_from(second.front(), matched).way_m, 3);
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
TEST(SharedPartOwnWay, IsNowhereNearTheOthers) {
  Placed placed;
  placed.add(row(0, 9));
  const std::vector<PatchId> second = placed.add(row(0, 3, 0.5));
  const SharedPart of_both = placed.shared_from(second.front(), second);
  EXPECT_EQ(of_both.own_first_m, 3);
  EXPECT_EQ(of_both.own_second_m, 0);
  EXPECT_EQ(of_both.way_m, 4);
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
  alike.add({{0, 0}});
  EXPECT_EQ(alike.shared_from(alike.add({{0, 0}}).front(), {}).border_contradiction, 0);
  Placed unlike;
  unlike.add({{0, 0}}, 2);
  EXPECT_EQ(unlike.shared_from(unlike.add({{0, 0}}, 4).front(), {}).border_contradiction, 1);
  Placed far;
  far.add({{0, 0}}, 2);
  EXPECT_EQ(far.shared_from(far.add({{7, 0}}, 20).front(), {}).border_contradiction, 0)
      << "where their views do not meet";
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
