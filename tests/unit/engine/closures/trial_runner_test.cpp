#include "server/engine/closures/trial_runner.hpp"

#include <gtest/gtest.h>

#include "tests/support/side_by_side.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

/// That R2's first patch lies beside R1's, where it truly does.
Proposal proposal_of(const SideBySide& scene) {
  Proposal proposal;
  proposal.id = ClosureId{5};
  proposal.merge = true;
  proposal.older = scene.first[0];
  proposal.younger = scene.second[0];
  proposal.older_from_younger = inverse(scene.second_from_world);
  proposal.relations = {odometry_relation(scene.first[0], scene.second[0], {0, 1.5, 0})};
  proposal.supporters = 6;
  proposal.two_way = true;
  return proposal;
}

/// Events a tenth of a second apart, until the trial is to be taken; how many there were.
int work_to_the_end(TrialRunner& runner, SideBySide& scene) {
  int events = 1;
  while (!runner.work(scene.world(10 + 0.1 * events)) && events < 10'000) ++events;
  return events;
}

TEST(TrialRunner, WorksAtATrialFromEventToEventUntilItIsToBeRuledOn) {
  SideBySide scene;
  TrialRunner runner;
  EXPECT_FALSE(runner.work(scene.world(10))) << "nothing is on trial";
  runner.begin(scene.world(10), proposal_of(scene));
  EXPECT_TRUE(runner.is_on_trial(ClosureId{5}));
  EXPECT_FALSE(runner.is_on_trial(ClosureId{4}));
  EXPECT_GT(work_to_the_end(runner, scene), 3) << "bounded steps";
  const std::unique_ptr<Trial> trial = runner.take();
  ASSERT_TRUE(trial);
  EXPECT_TRUE(trial->accepted()) << word(trial->refusal());
  EXPECT_EQ(runner.trial(), nullptr);
}

TEST(TrialRunner, LeavesAnEventThatBringsAPatchToThePatch) {
  SideBySide scene;
  TrialRunner runner;
  runner.work(scene.world(10));
  runner.begin(scene.world(10), proposal_of(scene));
  work_to_the_end(runner, scene);
  const PatchId id = scene.map.manifold().next_id();
  scene.map.add(patch_from(furnished_room(), id, {}), {});
  EXPECT_FALSE(runner.work(scene.world(2000)));
  EXPECT_TRUE(runner.work(scene.world(2000.1)));
}

TEST(TrialRunner, StepsToTheEndWhateverTheCredit) {
  SideBySide scene;
  TrialRunner runner;
  runner.begin(scene.world(10), proposal_of(scene));
  int steps = 0;
  for (; !runner.trial()->done() && steps < 1'000; ++steps) runner.step(scene.world(10));
  EXPECT_TRUE(runner.trial()->accepted());
  EXPECT_GT(steps, 1);
}

}  // namespace
}  // namespace isthmus
