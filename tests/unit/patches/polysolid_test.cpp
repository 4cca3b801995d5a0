#include "patches/polysolid.hpp"

#include <gtest/gtest.h>

#include "tests/support/patch_scenes.hpp"
#include "tests/support/solids.hpp"

namespace isthmus {
namespace {

using testing::area_m2;
using testing::rectangle;
using testing::solid;
using testing::united;

TEST(Polysolid, EmptyOnesAreTakenByEveryFunction) {
  const Polysolid none;
  const Polysolid square = solid(rectangle(0, 0, 1, 1));
  EXPECT_TRUE(united({}).empty());
  EXPECT_FALSE(overlap(none, none));
  EXPECT_FALSE(overlap(square, none));
  EXPECT_EQ(area_m2(none), 0);
  EXPECT_FALSE(contains(none, {0, 0}));
  EXPECT_TRUE(transformed({1, 2, 3}, none).empty());
  EXPECT_EQ(to_wkt(none), "MULTIPOLYGON EMPTY");
}

TEST(Polysolid, UnionOfTwoSquaresCountsWhatTheyShareOnce) {
  const Polysolid a = solid(rectangle(0, 0, 2, 2));
  const Polysolid b = solid(rectangle(1, 1, 3, 3));
  EXPECT_NEAR(area_m2(united({a, b})), 7, 1e-9);
  EXPECT_TRUE(overlap(a, b));
}

TEST(Polysolid, ClockwiseRingIsTurned) {
  const Polysolid square = solid({{0, 1}, {1, 1}, {1, 0}, {0, 0}});
  ASSERT_EQ(square.polygons().size(), 1U);
  EXPECT_NEAR(area_m2(square), 1, 1e-12);
}

TEST(Polysolid, HoleIsOutsideAndAnIslandInItIsInside) {
  //  +-----------+
  //  | +-------+ |
  //  | | +---+ | |
  //  | | | X | | |   a frame, and an island in its hole
  //  | | +---+ | |
  //  | +-------+ |
  //  +-----------+
  const Polysolid frame = solid(rectangle(0, 0, 6, 6), {rectangle(1, 1, 5, 5)});
  const Polysolid with_island = united({frame, solid(rectangle(2, 2, 4, 4))});
  EXPECT_NEAR(area_m2(frame), 20, 1e-9);
  EXPECT_FALSE(contains(frame, {3, 3}));
  EXPECT_NEAR(area_m2(with_island), 24, 1e-9);
  EXPECT_EQ(with_island.polygons().size(), 2U);
  EXPECT_TRUE(contains(with_island, {3, 3}));
  EXPECT_FALSE(contains(with_island, {1.5, 3}));
}

TEST(Polysolid, RingsAreTurnedAsTheyShouldBe) {
  const Polysolid frame = solid(rectangle(0, 0, 6, 6), {rectangle(1, 1, 5, 5)});
  ASSERT_EQ(frame.polygons().size(), 1U);
  ASSERT_EQ(frame.polygons()[0].holes.size(), 1U);
  EXPECT_GT(signed_area_m2(frame.polygons()[0].outer), 0);
  EXPECT_LT(signed_area_m2(frame.polygons()[0].holes[0]), 0);
  EXPECT_NEAR(area_m2(united({frame, solid(rectangle(0.5, 0.5, 5.5, 5.5))})), 36, 1e-9);
}

TEST(Polysolid, FrameClosedAtASinglePointKeepsItsHole) {
  // Two L shapes that meet along an edge at one end and at a single corner at the other.
  const Polysolid lower = solid({{0, 0}, {3, 0}, {3, 2}, {2, 2}, {2, 1}, {0, 1}});
  const Polysolid upper = solid({{0, 1}, {1, 1}, {1, 2}, {2, 2}, {2, 3}, {0, 3}});
  const Polysolid frame = united({lower, upper});
  EXPECT_NEAR(area_m2(frame), area_m2(lower) + area_m2(upper), 1e-9);
  EXPECT_FALSE(contains(frame, {1.5, 1.5}));
  EXPECT_TRUE(contains(frame, {0.5, 1.5}));
  EXPECT_NEAR(area_m2(united({frame, solid(rectangle(1, 1, 2, 2))})), area_m2(frame) + 1, 1e-9);
}

TEST(Polysolid, IslandAtTheRimOfAHoleStaysFree) {
  const Polysolid frame = solid(rectangle(0, 0, 6, 6), {rectangle(1, 1, 5, 5)});
  const Polysolid with_island = united({frame, solid({{1, 1}, {3, 2}, {2, 3}})});
  EXPECT_NEAR(area_m2(with_island), 21.5, 1e-9);
  EXPECT_TRUE(contains(with_island, {1.8, 1.8}));
  EXPECT_FALSE(contains(with_island, {4, 4}));
  EXPECT_NEAR(area_m2(united({with_island, solid(rectangle(1, 1, 5, 5))})), 36, 1e-9);
}

TEST(Polysolid, SquaresThatShareOnlyABoundaryDoNotOverlap) {
  const Polysolid a = solid(rectangle(0, 0, 1, 1));
  EXPECT_FALSE(overlap(a, solid(rectangle(1, 0, 2, 1)))) << "an edge";
  EXPECT_FALSE(overlap(a, solid(rectangle(1, 1, 2, 2)))) << "a corner";
  EXPECT_FALSE(overlap(a, solid({{1, 0.5}, {2, -1}, {2, 3}, {0, 3}, {0, 1}, {1, 1}}))) << "boxes overlap";
  EXPECT_TRUE(overlap(a, a));
  EXPECT_TRUE(overlap(a, solid(rectangle(0, 0, 1, 0.5)))) << "inside, sharing edges";
}

TEST(Polysolid, OverlapSeesContainmentAndHoles) {
  const Polysolid frame = solid(rectangle(0, 0, 6, 6), {rectangle(1, 1, 5, 5)});
  EXPECT_TRUE(overlap(solid(rectangle(-1, -1, 7, 7)), frame));
  EXPECT_TRUE(overlap(frame, solid(rectangle(0.2, 0.2, 0.8, 0.8))));
  EXPECT_FALSE(overlap(frame, solid(rectangle(2, 2, 4, 4)))) << "within the hole";
  EXPECT_TRUE(overlap(frame, solid(rectangle(0.5, 0.5, 5.5, 5.5)))) << "around the hole";
}

TEST(Polysolid, DegenerateRingsGiveNothing) {
  const double nan = std::nan("");
  EXPECT_TRUE(solid({}).empty());
  EXPECT_TRUE(solid({{1, 1}}).empty());
  EXPECT_TRUE(solid({{0, 0}, {1, 1}}).empty());
  EXPECT_TRUE(solid({{0, 0}, {1, 1}, {2, 2}}).empty());
  EXPECT_TRUE(solid({{nan, 0}, {1, nan}, {2, 2}}).empty());
  EXPECT_TRUE(solid({{0, 0}, {1e300, 0}, {0, 1e300}}).empty());
}

TEST(Polysolid, BowTieIsItsTwoTriangles) {
  const Polysolid tie = solid({{0, 0}, {1, 1}, {1, 0}, {0, 1}});
  EXPECT_NEAR(area_m2(tie), 0.5, 1e-9);
  EXPECT_TRUE(contains(tie, {0.1, 0.5}));
  EXPECT_FALSE(contains(tie, {0.5, 0.9}));
}

TEST(Polysolid, HoleThatSticksOutIsCut) {
  const Polysolid notched = solid(rectangle(0, 0, 2, 2), {rectangle(1, 1, 3, 3)});
  EXPECT_NEAR(area_m2(notched), 3, 1e-9);
}

TEST(Polysolid, UnionOfNearlyTheSameIsEitherOfThem) {
  // Their boundaries differ by rounding.
  const Polysolid wedge = solid({{0, 0}, {5.1, -0.7}, {5.3, 0.4}, {4.9, 1.3}});
  for (int i = 1; i < 40; ++i) {
    const Pose motion{0.37 * i, -0.91 * i, 0.13 * i};
    const Polysolid back = transformed(inverse(motion), transformed(motion, wedge));
    EXPECT_NEAR(area_m2(united({wedge, back})), area_m2(wedge), 1e-5) << i;
  }
}

TEST(Polysolid, PolygonsThatOverlapAreUnited) {
  const Polysolid both({{rectangle(0, 0, 2, 2), {}}, {rectangle(1, 0, 3, 2), {}}});
  EXPECT_EQ(both.polygons().size(), 1U);
  EXPECT_NEAR(area_m2(both), 6, 1e-9);
}

TEST(Polysolid, UnionOfManyIsTheUnionOneByOne) {
  std::vector<Polysolid> parts;
  Polysolid one_by_one;
  for (int i = 0; i < 13; ++i) {
    parts.push_back(solid(rectangle(0.7 * i, 0.1 * i, 0.7 * i + 1, 0.1 * i + 1)));
    one_by_one = united({one_by_one, parts.back()});
  }
  EXPECT_EQ(united(parts).polygons().size(), 1U);
  EXPECT_NEAR(area_m2(united(parts)), area_m2(one_by_one), 1e-9);
  EXPECT_NEAR(area_m2(one_by_one), 13 - 12 * 0.3 * 0.9, 1e-9);
}

TEST(Polysolid, StraightPointsLeftByAUnionGo) {
  const Polysolid wide = united({solid(rectangle(0, 0, 1, 1)), solid(rectangle(1, 0, 2, 1))});
  ASSERT_EQ(wide.polygons().size(), 1U);
  EXPECT_EQ(wide.polygons()[0].outer.size(), 4U);
}

TEST(Polysolid, TransformedMovesPoints) {
  const Polysolid moved = transformed({10, 0, std::numbers::pi / 2}, solid(rectangle(0, 0, 2, 1)));
  EXPECT_TRUE(contains(moved, {9.5, 1.5}));
  EXPECT_FALSE(contains(moved, {10.5, 0.5}));
  EXPECT_TRUE(transformed({std::nan(""), 0, 0}, moved).empty());
}

TEST(Polysolid, UncheckedRingsWithoutPointsAreTakenByEveryFunction) {
  const Polysolid hollow = Polysolid::of_sound({{{}, {{}, {}}}});
  const Polysolid square = solid(rectangle(0, 0, 1, 1));
  EXPECT_NEAR(area_m2(united({hollow, square})), 1, 1e-12);
  EXPECT_FALSE(overlap(hollow, square));
  EXPECT_FALSE(contains(hollow, {0, 0}));
  EXPECT_EQ(area_m2(transformed({1, 2, 3}, hollow)), 0);
  EXPECT_EQ(to_wkt(hollow), "MULTIPOLYGON ((EMPTY, EMPTY, EMPTY))");
}

TEST(Polysolid, WktClosesRingsAndHasNoNegativeZero) {
  const Polysolid frame = solid({{-1e-9, 0}, {3, 0}, {3, 3}, {0, 3}}, {rectangle(1, 1, 2, 2)});
  EXPECT_EQ(to_wkt(solid(rectangle(0, 0, 1, 1.25)), 2),
            "MULTIPOLYGON (((0.00 0.00, 1.00 0.00, 1.00 1.25, 0.00 1.25, 0.00 0.00)))");
  EXPECT_EQ(to_wkt(frame, 1).find('-'), std::string::npos);
  EXPECT_NE(to_wkt(frame, 1).find("), ("), std::string::npos);
}

}  // namespace
}  // namespace isthmus
