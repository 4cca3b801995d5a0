#include "server/features/fusion/landmark_tree.hpp"

#include <gtest/gtest.h>

#include <random>

namespace isthmus {
namespace {

TEST(LandmarkTree, FindsWhatTryingAllFinds) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(0, 30);
  std::vector<Feature> posts;
  for (int i = 0; i < 300; ++i) posts.push_back(point_feature({place(random), place(random)}));
  const LandmarkTree tree(posts);
  for (int question = 0; question < 50; ++question) {
    const Eigen::Vector2d at(place(random), place(random));
    std::vector<std::size_t> expected;
    for (std::size_t i = 0; i < posts.size(); ++i)
      if ((posts[i].a - at).norm() < 3) expected.push_back(i);
    EXPECT_EQ(tree.within(at, 3), expected);
  }
}

TEST(LandmarkTree, AWallIsFoundAnywhereAlongItAndOnce) {
  const LandmarkTree tree(std::vector{segment_feature({0, 0}, {20, 0}, true, true), point_feature({50, 0})});
  EXPECT_EQ(tree.within({13.3, 0.5}, 2), std::vector<std::size_t>{0});
  EXPECT_TRUE(tree.within({30, 0}, 2).empty());
}

TEST(LandmarkTree, OfNothingFindsNothing) {
  EXPECT_TRUE(LandmarkTree(std::vector<Feature>{}).within({0, 0}, 10).empty());
}

}  // namespace
}  // namespace isthmus
