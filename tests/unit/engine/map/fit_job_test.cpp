#include "server/engine/map/fit_job.hpp"

#include <gtest/gtest.h>

#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using testing::odometry_relation;

// Patches a metre apart by their relations, while the map has all of them at its origin:
//
//     0 --- 1 --- 2 --- 3        4 (alone)
Map crumpled_chain() {
  Map map;
  for (int i = 0; i < 5; ++i) {
    auto patch = std::make_shared<Patch>();
    patch->id = PatchId{i};
    map.add(patch, {});
    if (i > 0 && i < 4) map.relate(odometry_relation(PatchId{i - 1}, PatchId{i}, {1, 0, 0}));
  }
  return map;
}

// Eq. 16 of the island, whatever the map does meanwhile.
TEST(FitJob, FitsTheIslandAsItWasWhenItBegan) {
  Map map = crumpled_chain();
  FitJob job(map, PatchId{0}, 0, {}, {});
  map.move_island(PatchId{0}, {5, 5, 1});
  const FitJob::Result result = job.take();
  EXPECT_TRUE(result.ok);
  EXPECT_EQ(job.island(), PatchId{0});
  ASSERT_EQ(result.patches.size(), 4U);
  ASSERT_EQ(result.poses.size(), 5U);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(result.patches[static_cast<std::size_t>(i)], PatchId{i});
    EXPECT_NEAR(result.poses[static_cast<std::size_t>(i)].x, i, 1e-6);
  }
  EXPECT_EQ(result.poses[4], Pose{}) << "what is not on the island stays";
  EXPECT_FALSE(result.covariance);
}

// Three steps of σ = 0.1 m one after the other, in the graph asked about: variances add up.
TEST(FitJob, TellsHowSurelyOnePatchWasKnownFromAnother) {
  const Map map = crumpled_chain();
  RelationGraph before;
  for (int i = 0; i < 5; ++i) before.add_patch(PatchId{i});
  for (int i = 1; i < 4; ++i) before.add(odometry_relation(PatchId{i - 1}, PatchId{i}, {}, {100, 100, 1e6}));
  FitJob job(map, PatchId{0}, 0, FitJob::LoopQuestion{before, PatchId{0}, PatchId{3}, {}, {}, {}, {}}, {});
  const FitJob::Result result = job.take();
  ASSERT_TRUE(result.covariance);
  EXPECT_NEAR((*result.covariance)(0, 0), 0.03, 1e-4);
  EXPECT_NEAR((*result.covariance)(2, 2), 3e-6, 1e-8);
}

TEST(FitJob, TellsByWhichClosuresThatWasKnown) {
  const Map map = crumpled_chain();
  RelationGraph before;
  for (int i = 0; i < 5; ++i) before.add_patch(PatchId{i});
  for (int i = 1; i < 4; ++i) before.add(odometry_relation(PatchId{i - 1}, PatchId{i}, {}, {100, 100, 1e6}));
  Relation closure = odometry_relation(PatchId{0}, PatchId{3}, {}, {100, 100, 1e6});
  closure.origin = {OriginKind::hypothesis, ClosureId{7}};
  before.add(closure);
  FitJob job(map, PatchId{0}, 0, FitJob::LoopQuestion{before, PatchId{0}, PatchId{3}, {}, {}, {}, {}}, {});
  EXPECT_EQ(job.take().rests_on, std::vector<ClosureId>{ClosureId{7}});
}

// A way of nine metres along which a loop was closed wrongly, and another that is right:
//
//     0 -- 1 -- 2 -- ... -- 7 -- 8 -- 9
//               +--- wrong -+
//     +------------- right -----------+
TEST(FitJob, BlamesALoopThatWasClosedBeforeUnlessASlipIsLikelier) {
  const ClosureId wrong{7};
  Map map;
  for (int i = 0; i < 10; ++i) {
    auto patch = std::make_shared<Patch>();
    patch->id = PatchId{i};
    map.add(patch, {1.0 * i, 0, 0});
    if (i > 0) map.relate(odometry_relation(PatchId{i - 1}, PatchId{i}, {1, 0, 0}, {1000, 1000, 4000}));
  }
  Relation earlier = odometry_relation(PatchId{2}, PatchId{7}, {4, 1.5, 0.5}, {2500, 2500, 10000});
  earlier.origin = {OriginKind::hypothesis, wrong};
  map.relate(earlier);
  map.refit_island(PatchId{0});
  const RelationGraph before = map.graph();
  const Pose moved = Pose{9, 0, 0} * inverse(map.manifold().pose(PatchId{9}));
  Relation right = odometry_relation(PatchId{0}, PatchId{9}, {9, 0, 0}, {2500, 2500, 10000});
  right.origin = {OriginKind::hypothesis, ClosureId{8}};
  map.relate(right);
  const auto blamed = [&](bool may_have_slipped) {
    const OpenLoop loop{{PatchId{0}}, {PatchId{9}}, moved, 9, {{wrong, 5}}};
    FitJob job(map, PatchId{0}, 0,
               FitJob::LoopQuestion{before, PatchId{0}, PatchId{9}, loop, {}, {}, {}, may_have_slipped}, {});
    return job.take().blamed_closure;
  };
  EXPECT_EQ(blamed(false), wrong);
  EXPECT_FALSE(blamed(true).valid()) << "that is 5, that nothing slipped 3";
}

// As many events as the island has patches, or 20 ms a patch: by what the engine is told, never by the clock.
TEST(FitJob, IsDueByEventsAndTheirTimeAlone) {
  const Map map = crumpled_chain();  // of four, and one that is alone
  FitJob by_events(map, PatchId{0}, 1'000'000, {}, {});
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(by_events.advance(1'000'000));
  EXPECT_TRUE(by_events.advance(1'000'000));
  FitJob by_time(map, PatchId{0}, 1'000'000, {}, {});
  EXPECT_FALSE(by_time.advance(1'079'999));
  EXPECT_TRUE(by_time.advance(1'080'000));
}

}  // namespace
}  // namespace isthmus
