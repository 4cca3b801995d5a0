#include <gtest/gtest.h>

#include "tests/support/feature_worlds.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

/// Mean NEES/3 over the second half of a drive of three rounds, which landmark is which being known.
double mean_nees(FilterForm form, std::uint32_t seed) {
  const LandmarkWorld world;
  std::mt19937 random(seed);
  FilterOptions options;
  options.form = form;
  FeatureFilter filter(options);
  filter.add_robot({}, Eigen::Matrix3d::Zero());
  std::vector<int> ids(world.landmarks.size(), -1);
  Pose truth;
  double sum = 0;
  int count = 0;
  for (int step = 0; step < 380; ++step) {
    truth = truth * world.true_step();
    filter.move(0, world.odometry(random), world.odometry_covariance());
    const LandmarkWorld::Seen seen = world.look(truth, random);
    std::vector<int> known;
    for (const int which : seen.which) known.push_back(ids[static_cast<std::size_t>(which)]);
    const std::vector<int> now = filter.observe_known(0, seen.features, known);
    for (std::size_t i = 0; i < now.size(); ++i) ids[static_cast<std::size_t>(seen.which[i])] = now[i];
    if (step < 190) continue;
    sum += pose_nees(filter.state(), 0, truth) / 3;
    ++count;
  }
  return sum / count;
}

double mean_over_seeds(FilterForm form) {
  constexpr std::uint32_t seeds = 20;
  double sum = 0;
  for (std::uint32_t seed = 1; seed <= seeds; ++seed) sum += mean_nees(form, seed);
  return sum / seeds;
}

TEST(Consistency, TheInvariantFilterErrsAsMuchAsItSaysAndThePrintedOneDoesNot) {
  const double invariant = mean_over_seeds(FilterForm::invariant);
  EXPECT_GT(invariant, 0.8);
  EXPECT_LT(invariant, 1.3);
  EXPECT_GT(mean_over_seeds(FilterForm::printed), 1.3 * invariant);
}

}  // namespace
}  // namespace isthmus
