#include <gtest/gtest.h>

#include <cmath>

#include "server/output/grid/coverage.hpp"
#include "server/output/grid/hits.hpp"

namespace isthmus {
namespace {

const Lattice lattice{0.1, -50, -50, 100, 100};  // 10 m by 10 m about the origin

int covered(const Coverage& coverage, int column, int row) {
  int sum = 0;
  for (int i = 0; i <= column; ++i) sum += coverage.steps_of_row(row)[static_cast<std::size_t>(i)];
  return sum;
}

Ring square(double half_m) {
  return {{-half_m, -half_m}, {half_m, -half_m}, {half_m, half_m}, {-half_m, half_m}};
}

//   +-------+
//   |  +-+  |    A room about a pillar.
//   |  +-+  |
//   +-------+
TEST(Coverage, LeavesOutTheHolesOfFreeSpace) {
  Ring pillar = square(1);
  std::ranges::reverse(pillar);
  Coverage coverage(lattice);
  coverage.add(Polysolid({PolygonWithHoles{square(3), {pillar}}}), {});
  EXPECT_EQ(covered(coverage, 50, 50), 0) << "within the pillar";
  EXPECT_EQ(covered(coverage, 35, 50), 1);
  EXPECT_EQ(covered(coverage, 65, 50), 1);
  EXPECT_EQ(covered(coverage, 50, 65), 1);
  EXPECT_EQ(covered(coverage, 85, 50), 0) << "outside";
}

// Hits along one wall: neighbouring beams that end 20 cm apart show the wall between them, 50 cm apart they
// do not: there may be a door.
TEST(Hits, JoinNeighbouringBeamsOnOneSurfaceOnlyWhereTheyEndNearOneAnother) {
  for (const auto& [gap_m, joined] : {std::pair{0.2, true}, {0.5, false}}) {
    Patch patch;
    Scan scan{0, -0.5, 1.0 / 180, std::vector<float>(181, 6)};
    patch.star = Star(scan, {}, 20, 0);
    for (int i = 0; i < 2; ++i) patch.points.push_back({{3, i * gap_m + 0.05}, {-1, 0}, i});
    Hits hits(lattice);
    hits.add(patch, Pose{0.05, 0, 0});
    const int between = 50 + static_cast<int>(0.5 * gap_m / 0.1);
    EXPECT_EQ(hits.count(80, 50), 1);
    EXPECT_EQ(hits.count(80, between), joined ? 1 : 0) << gap_m;
  }
}

}  // namespace
}  // namespace isthmus
