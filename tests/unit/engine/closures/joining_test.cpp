// Islands of patches a metre apart along x, and what an operator has forbidden between them.

#include "server/engine/closures/joining.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "server/engine/input/engine_options.hpp"
#include "server/engine/map/map.hpp"

namespace isthmus {
namespace {

Relation pose_relation(PatchId a, PatchId b, const Pose& a_from_b, double sigma_m, double sigma_rad) {
  Relation relation;
  relation.a = a;
  relation.b = b;
  relation.kind = RelationKind::odometry;
  relation.origin = {OriginKind::odometry, {}};
  const Eigen::Vector3d sigmas(sigma_m, sigma_m, sigma_rad);
  relation.measurement =
      RelativePose{a_from_b, Eigen::Matrix3d(sigmas.cwiseProduct(sigmas).cwiseInverse().asDiagonal())};
  return relation;
}

/// Adds a chain of patches; each step errs by so much.
std::vector<PatchId> add_chain(Map& map, const std::string& robot, int size, double sigma_m,
                               double sigma_rad) {
  std::vector<PatchId> ids;
  for (int i = 0; i < size; ++i) {
    auto patch = std::make_shared<Patch>();
    patch->id = map.manifold().next_id();
    patch->robot = robot;
    ids.push_back(patch->id);
    map.add(patch, {1.0 * i, 0, 0});
    if (i > 0) map.relate(pose_relation(ids[ids.size() - 2], ids.back(), {1, 0, 0}, sigma_m, sigma_rad));
  }
  return ids;
}

/// The map with the island of `b` joined so that b lies in a as given.
Map joined(Map map, PatchId a, PatchId b, const Pose& a_from_b) {
  const Pose new_from_old = map.manifold().pose(a) * a_from_b * inverse(map.manifold().pose(b));
  if (map.graph().island(a) != map.graph().island(b)) map.move_island(map.graph().island(b), new_from_old);
  map.relate(pose_relation(a, b, a_from_b, 0.05, 0.02));
  return map;
}

struct Two {
  Map map;
  std::vector<PatchId> first, second;

  explicit Two(double sigma_m = 0.02, double sigma_rad = 0.005) {
    first = add_chain(map, "R1", 30, sigma_m, sigma_rad);
    second = add_chain(map, "R2", 30, sigma_m, sigma_rad);
  }
  /// That their first patches lie side by side.
  Joining side_by_side() const {
    const Map made = joined(map, first[0], second[0], {0, 1, 0});
    return as_mapped(made, {first[0], second[0], {}, Eigen::Matrix3d::Zero()});
  }
};

TEST(Joining, AsMappedIsWhereTheMapHasItsEnds) {
  const Two two;
  const Joining joining = two.side_by_side();
  EXPECT_NEAR(joining.first_from_second.y, 1, 1e-9);
  EXPECT_NEAR(joining.covariance(0, 0), 0.05 * 0.05, 1e-9);
  EXPECT_EQ(as_mapped(two.map, joining).first_from_second, joining.first_from_second) << "on two islands";
}

TEST(Joining, IsFoundAgainFromAnyOtherPlace) {
  const Two two;
  const Joining forbidden = two.side_by_side();
  EXPECT_TRUE(brings_about(two.map, joined(two.map, two.first[0], two.second[0], {0, 1, 0}), forbidden, {}));
  EXPECT_TRUE(
      brings_about(two.map, joined(two.map, two.first[25], two.second[20], {-5, 1, 0}), forbidden, {}));
}

TEST(Joining, IsNotAnotherAtAClearlyDifferentPlace) {
  const Two two;
  const Joining forbidden = two.side_by_side();
  for (const Pose& elsewhere : {Pose{3, 1, 0}, Pose{0, -4, 0}, Pose{0, 1, 1}, Pose{0, 1, 3.1}})
    EXPECT_FALSE(
        brings_about(two.map, joined(two.map, two.first[0], two.second[0], elsewhere), forbidden, {}));
}

// What has drifted by two metres over the way is the same where so much drift is to be expected, and is not
// where it is not.
TEST(Joining, IsTheSameAsFarAsTheWayMayHaveDrifted) {
  for (const auto& [sigma_m, same] : {std::pair(0.02, false), std::pair(0.2, true)}) {
    const Two two(sigma_m, 0.001);
    const Map drifted = joined(two.map, two.first[29], two.second[29], {2, 1, 0});
    EXPECT_EQ(brings_about(two.map, drifted, two.side_by_side(), {}), same) << sigma_m;
  }
}

TEST(Joining, IsFoundThroughAThirdIsland) {
  Two two;
  const Joining forbidden = two.side_by_side();
  const std::vector<PatchId> third = add_chain(two.map, "R3", 30, 0.02, 0.005);
  const Map with_third = joined(two.map, two.first[5], third[5], {0, 5, 0});
  EXPECT_FALSE(brings_about(two.map, with_third, forbidden, {}));
  EXPECT_TRUE(
      brings_about(with_third, joined(with_third, third[8], two.second[8], {0, -4, 0}), forbidden, {}));
  EXPECT_FALSE(
      brings_about(with_third, joined(with_third, third[8], two.second[8], {0, 4, 0}), forbidden, {}));
}

TEST(Joining, OfALoopIsWhatBringsItsEndsTogether) {
  Map map;
  const std::vector<PatchId> way = add_chain(map, "R1", 40, 0.1, 0.001);
  // That the way came back by two metres: within what it may have drifted, so the map alone does not refute
  // it.
  Joining forbidden{way[0], way[39], {37, 0, 0}, Eigen::Matrix3d::Identity() * 1e-3};
  Map closed = map;
  closed.relate(pose_relation(way[1], way[38], {35, 0, 0}, 0.05, 0.02));
  closed.refit_island(way[0]);
  EXPECT_TRUE(brings_about(map, closed, forbidden, {}));
  Map elsewhere = map;  // a small loop far from its ends
  elsewhere.relate(pose_relation(way[18], way[21], {3, 0, 0}, 0.05, 0.02));
  EXPECT_FALSE(brings_about(map, elsewhere, forbidden, {}));
}

TEST(Joining, ATagsHeadingMeansNothing) {
  Two two;
  auto tag = std::make_shared<Patch>();
  tag->id = two.map.manifold().next_id();
  tag->tag = 7;
  two.map.add(tag, {3, 2, 0});
  two.map.relate(pose_relation(two.second[3], tag->id, {0, 2, 0}, 0.05, 100));
  EXPECT_EQ(ground_of(two.map, tag->id), two.second[3]);
  EXPECT_EQ(ground_of(two.map, two.first[1]), two.first[1]);
  Joining forbidden{two.first[3], tag->id, {0, 2, 2.5}, Eigen::Matrix3d::Zero(), true};
  const Map same = joined(two.map, two.first[3], two.second[3], {0, 0, 0});
  EXPECT_TRUE(brings_about(two.map, same, forbidden, {}));
  forbidden.first_from_second.y = 4;
  EXPECT_FALSE(brings_about(two.map, same, forbidden, {}));
}

// A trial may be older than what has been forbidden since.
TEST(Joining, OfPatchesThatAMapLacksIsNotBroughtAbout) {
  const Two two;
  const Joining newer{two.first[0], PatchId{1000}, {}, Eigen::Matrix3d::Zero()};
  EXPECT_FALSE(brings_about(two.map, two.map, newer, {}));
}

}  // namespace
}  // namespace isthmus
