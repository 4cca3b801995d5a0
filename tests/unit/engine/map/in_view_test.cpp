#include "server/engine/map/in_view.hpp"

#include <gtest/gtest.h>

#include "tests/support/walls.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

InView of_points(const Walls& points, const Walls& by, const Pose& by_from_points = {}) {
  LocalMap local;
  local.patches.push_back({patch_from(by, PatchId{0}, {}), {}});
  return in_view(local, patch_from(points, PatchId{1}, {})->points, by_from_points, {});
}

TEST(InView, IsAllWhereBothSeeTheSame) {
  const InView view = of_points(furnished_room(), furnished_room());
  EXPECT_GT(view.seen, 100);
  EXPECT_EQ(view.share(), 1);
  EXPECT_EQ(view.share_seen(), 1);
}

TEST(InView, IsLookedThroughWhereWallsStandInFreeSpace) {
  const InView view = of_points(box(2), box(4));
  EXPECT_EQ(view.share(), 1);
  EXPECT_EQ(view.share_seen(), 0);
}

TEST(InView, SaysNothingOfWhatIsHidden) {
  const InView view = of_points(box(4), box(2));
  EXPECT_GT(view.out_of_view, 100);
  EXPECT_EQ(view.share(), 0);
  EXPECT_EQ(view.share_seen(), 0);
}

// A robot that looks ahead: the wall there, moved to half as far, stands in free space, and of the walls on
// either side what is moved behind it is out of view.
TEST(InView, LooksFromWhereThePointsLie) {
  const InView moved = of_points(box(3), box(3), {-1.5, 0, 0});
  EXPECT_GT(moved.looked_through, 20);
  EXPECT_GT(moved.out_of_view, 10);
  EXPECT_GT(moved.seen, 20) << "along the walls on either side";
  const int in_view = moved.seen + moved.looked_through;
  EXPECT_EQ(moved.share_seen(), static_cast<double>(moved.seen) / in_view) << "of what is in view";
  EXPECT_EQ(moved.share(), static_cast<double>(in_view) / (in_view + moved.out_of_view)) << "of all";
}

TEST(InView, IsByAnyOfThePatches) {
  LocalMap local;
  local.patches.push_back({patch_from(box(2), PatchId{0}, {}), {}});
  local.patches.push_back({patch_from(box(4), PatchId{1}, {}), {}});
  const InView view = in_view(local, patch_from(box(4), PatchId{2}, {})->points, {}, {});
  EXPECT_EQ(view.share_seen(), 1);
  EXPECT_EQ(view.out_of_view, 0);
}

TEST(InView, OfNothingIsNothing) {
  EXPECT_EQ(in_view({}, {}, {}, {}).share(), 0);
  EXPECT_EQ(in_view({}, {}, {}, {}).share_seen(), 0);
}

}  // namespace
}  // namespace isthmus
