#include "server/engine/localise/own_ground.hpp"

#include <gtest/gtest.h>

#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// Two robots' patches, a metre apart, at 1 s, 2 s, ...; what joins the robots' halves is taken away:
//
//     R1: 0 --- 1 - x - R2: 2 --- 3
struct Parting {
  Parting() {
    for (int i = 0; i < 4; ++i) {
      auto patch = std::make_shared<Patch>();
      patch->id = PatchId{i};
      patch->robot = i < 2 ? "R1" : "R2";
      patch->utime = 1'000'000 * (i + 1);
      together.add(patch, {1.0 * i, 0, 0});
    }
    together.relate(odometry_relation(PatchId{0}, PatchId{1}, {1, 0, 0}));
    together.relate(odometry_relation(PatchId{2}, PatchId{3}, {1, 0, 0}));
    parted = together;
    together.relate(odometry_relation(PatchId{1}, PatchId{2}, {1, 0, 0}));
  }
  PastPlace put_back(const std::string& robot, PatchId patch, std::int64_t utime) const {
    PastPlace place;
    place.utime = utime;
    place.pose = {patch, {0.2, 0.1, 0.5}};
    OwnGround(together, parted).put_back(robot, place);
    return place;
  }

  Map together;
  Map parted;
};

// Where R1 drove on R2's patch, it was 0.2 m past x = 3: seen from its own patch at x = 1, or at x = 0.
TEST(OwnGround, SaysWhereARobotWasByTheNewestPatchOfItsOwnUpToThen) {
  const Parting parting;
  const PastPlace late = parting.put_back("R1", PatchId{3}, 5'000'000);
  EXPECT_EQ(late.pose.patch, PatchId{1});
  EXPECT_NEAR(late.pose.patch_from_object.x, 2.2, 1e-9);
  EXPECT_NEAR(late.pose.patch_from_object.y, 0.1, 1e-9);
  EXPECT_NEAR(late.pose.patch_from_object.yaw, 0.5, 1e-9);
  const PastPlace early = parting.put_back("R1", PatchId{3}, 1'500'000);
  EXPECT_EQ(early.pose.patch, PatchId{0});
  EXPECT_NEAR(early.pose.patch_from_object.x, 3.2, 1e-9);
}

TEST(OwnGround, BeforeItsFirstPatchThatIsAllThereIs) {
  const PastPlace place = Parting().put_back("R2", PatchId{0}, 500'000);
  EXPECT_EQ(place.pose.patch, PatchId{2});
  EXPECT_NEAR(place.pose.patch_from_object.x, -1.8, 1e-9);
}

TEST(OwnGround, LeavesARobotThatWasOnItsOwnIsland) {
  const PastPlace place = Parting().put_back("R1", PatchId{0}, 5'000'000);
  EXPECT_EQ(place.pose.patch, PatchId{0});
  EXPECT_NEAR(place.pose.patch_from_object.x, 0.2, 1e-9);
}

// Nobody knows how two islands lie to one another that never were one.
TEST(OwnGround, LeavesARobotOnAnIslandThatItsOwnNeverTouched) {
  Parting parting;
  parting.together = parting.parted;
  EXPECT_EQ(parting.put_back("R1", PatchId{3}, 5'000'000).pose.patch, PatchId{3});
}

TEST(OwnGround, LeavesARobotWithoutPatches) {
  EXPECT_EQ(Parting().put_back("R3", PatchId{3}, 5'000'000).pose.patch, PatchId{3});
}

}  // namespace
}  // namespace isthmus
