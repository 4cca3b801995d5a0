#include "tools/simulate/evidence/evidence.hpp"

#include <gtest/gtest.h>

namespace isthmus {
namespace {

/// Patches 0 and 1 of R1 and R2, truly 2 m apart, and what closures say of them.
struct TwoSeen {
  MapCopy map;
  std::vector<RobotTruth> truth;

  TwoSeen() {
    for (int i = 0; i < 2; ++i) {
      auto patch = std::make_shared<Patch>();
      patch->id = PatchId{i};
      patch->robot = i == 0 ? "R1" : "R2";
      patch->utime = 5;
      map.patches.push_back(patch);
      RobotTruth robot;
      robot.robot = patch->robot;
      robot.poses.push_back({5, 0, {2.0 * i, 0, 0}});
      truth.push_back(robot);
    }
  }
  ClosureRecord says(const Pose& first_from_second, int supporters = 4) {
    ClosureRecord closure;
    closure.joining.first = PatchId{0};
    closure.joining.second = PatchId{1};
    closure.joining.first_from_second = first_from_second;
    closure.account.supporters = supporters;
    return closure;
  }
};

TEST(LabelledClosures, AreTrueWithinAMetreAndTwentyDegrees) {
  TwoSeen its;
  its.map.closures = {its.says({2.9, 0, 0.3}), its.says({3.1, 0, 0}), its.says({2, 0, 0.4})};
  const std::vector<LabelledClosure> labelled = label_closures("run", its.map, its.truth);
  ASSERT_EQ(labelled.size(), 3U);
  EXPECT_TRUE(labelled[0].is_true());
  EXPECT_NEAR(labelled[0].off_m, 0.9, 1e-9);
  EXPECT_FALSE(labelled[1].is_true()) << "1.1 m off";
  EXPECT_FALSE(labelled[2].is_true()) << "23 degrees off";
}

TEST(LabelledClosures, AreOnlyThoseThatWereTriedBetweenKnownPlaces) {
  TwoSeen its;
  ClosureRecord tag = its.says({2, 0, 0});
  tag.joining.point = true;
  its.map.closures = {its.says({2, 0, 0}, 0), tag};
  EXPECT_TRUE(label_closures("run", its.map, its.truth).empty());
  its.map.closures = {its.says({2, 0, 0})};
  its.truth[1].poses.clear();
  EXPECT_TRUE(label_closures("run", its.map, its.truth).empty());
}

TEST(LabelledFinds, AreTrueWhereTheRobotWas) {
  TwoSeen its;
  FindRecord find;
  find.anchor = PatchId{0};
  find.query = PatchId{1};
  for (const double x_m : {2.9, 3.1}) {
    find.anchor_from_query = {x_m, 0, 0.3};
    its.map.finds.push_back(find);
  }
  const std::vector<LabelledFind> labelled = label_finds("run", its.map, its.truth);
  ASSERT_EQ(labelled.size(), 2U);
  EXPECT_TRUE(labelled[0].is_true);
  EXPECT_FALSE(labelled[1].is_true) << "1.1 m off";
  its.truth[1].poses.clear();
  EXPECT_TRUE(label_finds("run", its.map, its.truth).empty()) << "nobody knows";
}

}  // namespace
}  // namespace isthmus
