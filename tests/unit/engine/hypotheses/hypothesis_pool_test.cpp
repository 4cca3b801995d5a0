#include "server/engine/hypotheses/hypothesis_pool.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "server/engine/hypotheses/hypothesis_counts.hpp"
#include "tests/support/side_by_side.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

/// Finds of R2's way beside R1's, 2.5 m long.
struct Pooling {
  SideBySide scene;
  HypothesisPool pool;
  Closures closures;
  HypothesisCounts counts;

  World world() { return scene.world(20); }
  /// So short a way is to be enough for the trial too.
  void believe_little() {
    TrialOptions& its = scene.options.trial;
    its.min_way_m = 1;
    its.min_width_m = its.min_own_m = 0;
  }
  /// That R2's patch lies so beside R1's.
  void find(std::size_t i, const Pose& first_from_second = {0, 1.5, 0}, int look_alikes = 1,
            double log_odds = 2) {
    const PatchId query = scene.second[i];
    const PatchId anchor = scene.first[i];
    const Relation relation = odometry_relation(anchor, query, first_from_second);
    pool.take(world(), "R2",
              {query, anchor, first_from_second, 0, 1, {relation}, look_alikes, 0.7, 0.7, 0.9, log_odds},
              counts);
  }
  bool propose() { return pool.propose(world(), closures, counts); }
  /// What is on trial is tried out, and heard of.
  void take_outcomes() {
    while (closures.step_trial(world())) {
    }
    pool.take_outcomes(world(), closures, counts);
  }
};

TEST(HypothesisPool, ProposesFindsThatAgree) {
  Pooling its;
  its.find(0);
  its.find(4);
  EXPECT_FALSE(its.propose()) << "two do not say enough";
  its.find(2);
  EXPECT_TRUE(its.propose());
  EXPECT_TRUE(its.closures.on_trial());
  EXPECT_EQ(its.counts.proposed, 1);
  ASSERT_EQ(its.closures.closures().size(), 1U);
  EXPECT_EQ(its.closures.closures()[0].robots, (std::vector<std::string>{"R1", "R2"}));
}

TEST(HypothesisPool, ProposesOnOneIslandWhatIsSureEnoughWhetherOneFindOrTwo) {
  for (const double log_odds : {-0.1, 0.1}) {
    Pooling its;
    its.scene.join();
    its.find(0, {0, 1.5, 0}, 1, log_odds);
    EXPECT_EQ(its.propose(), log_odds > 0);
  }
  Pooling its;
  its.scene.join();
  for (const std::size_t i : {0U, 4U}) its.find(i, {0, 1.5, 0}, 1, -0.5);
  EXPECT_TRUE(its.propose()) << "the second is worth log(0.9 / 0.5)";
}

// More of the building must match then; and which of two places it is, if it is one of two, only the map
// tells.
TEST(HypothesisPool, IsAsSureAsFindsSayUpToABoundAndOfOneFindOnePlaceOfTwo) {
  const TrialOptions its_trial;
  for (const auto& [finds, log_odds, prior] : {std::tuple{1U, 1.25, 1.25},
                                               {1U, 9.0, its_trial.lone_log_odds},
                                               {2U, 1.25, 1.25 + std::log(0.9 / 0.5)},
                                               {2U, 9.0, its_trial.agreed_log_odds}}) {
    Pooling its;
    its.scene.join();
    for (std::size_t i = 0; i < finds; ++i) its.find(4 * i, {0, 1.5, 0}, 1, log_odds);
    ASSERT_TRUE(its.propose());
    its.take_outcomes();
    const TrialAccount account = its.closures.closures().at(0).account;
    EXPECT_DOUBLE_EQ(account.prior_log_odds, prior);
    EXPECT_EQ(account.look_alikes, finds == 1 ? 2 : 1);
  }
}

TEST(HypothesisPool, ProposesAgainWhatIsUndecidedOnceItIsTwiceAsMuch) {
  Pooling its;
  its.scene.join();
  its.scene.options.trial.min_loop_log_odds = 1000;
  its.find(0);
  ASSERT_TRUE(its.propose());
  its.take_outcomes();
  ASSERT_EQ(its.pool.undecided().size(), 1U);
  EXPECT_FALSE(its.propose());
  its.find(2);
  EXPECT_TRUE(its.propose()) << "two";
  its.take_outcomes();
  its.find(4);
  EXPECT_FALSE(its.propose()) << "three";
  its.find(5);
  EXPECT_TRUE(its.propose()) << "four";
}

TEST(HypothesisPool, ProposesOnlyWhatFitsWellEnoughInAll) {
  for (const double surest : {1.7, 1.9}) {
    Pooling its;
    for (const std::size_t i : {0U, 2U, 4U}) its.find(i, {0, 1.5, 0}, 1, i == 2 ? surest : -1);
    EXPECT_EQ(its.propose(), surest > 1.8)
        << "each of the others is worth log(0.9 / 0.5), of 3 that are asked";
  }
}

// The three that are found most surely would be enough.
TEST(HypothesisPool, CountsThePlacesThatLookAlikeByTheFindsItNeeds) {
  Pooling its;
  const int look_alikes[] = {9, 1, 4, 2, 7};
  for (std::size_t i = 0; i < 5; ++i) its.find(i, {0, 1.5, 0}, look_alikes[i]);
  ASSERT_TRUE(its.propose());
  its.take_outcomes();
  ASSERT_EQ(its.closures.closures().size(), 1U);
  EXPECT_EQ(its.closures.closures()[0].account.look_alikes, 4);
}

// What a find says by itself, others that agree with it do not make less sure.
TEST(HypothesisPool, IsNoLessSureOfALoopForFindsThatAgree) {
  Pooling its;
  its.scene.join();
  its.find(0, {0, 1.5, 0}, 1);
  its.find(4, {0, 1.5, 0}, 21);
  ASSERT_TRUE(its.propose());
  its.take_outcomes();
  EXPECT_EQ(its.closures.closures().at(0).account.look_alikes, 2);
}

// Half a metre further on, whichever of the two asks.
TEST(HypothesisPool, SaysWhereToLookForWhatIsNearAFindThatWaits) {
  Pooling its;
  its.find(0);
  const Map& map = its.scene.map;
  const std::vector<PlaceHint> hints = its.pool.hints(map, its.scene.second[1], its.scene.options);
  ASSERT_EQ(hints.size(), 1U);
  EXPECT_EQ(hints[0].island, map.graph().island(its.scene.first[0]));
  const Pose moved = map.relative_pose(its.scene.second[0], its.scene.second[1]);
  const Pose expected = map.manifold().pose(its.scene.first[0]) * Pose{0, 1.5, 0} * moved;
  EXPECT_NEAR(ominus(hints[0].island_from_patch, expected).x, 0, 1e-9);
  EXPECT_NEAR(ominus(hints[0].island_from_patch, expected).y, 0, 1e-9);
  EXPECT_NEAR(hints[0].drift_m, 1 + 0.3 * std::hypot(moved.x, moved.y), 1e-9);

  const std::vector<PlaceHint> back = its.pool.hints(map, its.scene.first[1], its.scene.options);
  ASSERT_EQ(back.size(), 1U);
  EXPECT_EQ(back[0].island, map.graph().island(its.scene.second[0]));
  its.scene.options.hypotheses.hint_way_m = 0.1;
  EXPECT_TRUE(its.pool.hints(map, its.scene.second[1], its.scene.options).empty()) << "too far on";
}

// A robot that looks into a corridor and turns says as much; how much matches is for the trial.
TEST(HypothesisPool, ProposesFindsOfOnePlaceToo) {
  Pooling its;
  for (const std::size_t i : {0U, 1U, 2U}) its.find(i);
  EXPECT_TRUE(its.propose()) << "a metre of way";
}

TEST(HypothesisPool, ProposesNothingThatASurerFindContradicts) {
  for (const double rival : {3.0, 3.5}) {
    Pooling its;
    for (const std::size_t i : {0U, 2U, 4U}) its.find(i);
    its.find(1, {3, -1.5, 1}, 1, rival);
    EXPECT_EQ(its.propose(), rival < 3.1) << "the three are worth 2 + 2 log(0.9 / 0.5)";
  }
}

// Whichever of its ends is near: what one robot found of the other's way the other may have found of its own.
TEST(HypothesisPool, ProposesNothingThatASurerFindContradictsOfTheOtherRobot) {
  Pooling its;
  for (const std::size_t i : {0U, 2U, 4U}) its.find(i);
  const PatchId query = its.scene.first[1], anchor = its.scene.second[1];
  const Relation relation = odometry_relation(anchor, query, {3, -1.5, 1});
  its.pool.take(its.world(), "R1", {query, anchor, {3, -1.5, 1}, 0, 1, {relation}, 1, 0.7, 0.7, 0.9, 5},
                its.counts);
  EXPECT_FALSE(its.propose());
}

TEST(HypothesisPool, TakesFindsThatAgreeWithAClosureInWithItAndLetsThemGoWithIt) {
  Pooling its;
  its.believe_little();
  for (const std::size_t i : {0U, 2U, 4U}) its.find(i);
  ASSERT_TRUE(its.propose());
  its.find(3, {0, 1.51, 0}, 1, 0.5);
  its.find(1, {3, -1.5, 1}, 1, 0.5);
  its.take_outcomes();
  ASSERT_EQ(its.closures.closures()[0].state, ClosureState::accepted);
  EXPECT_EQ(its.pool.waiting(), 1U) << "that which says otherwise";
  const auto taken_in = [&] {
    int count = 0;
    for (const auto& [id, relation] : its.scene.map.graph().relations())
      count += relation.origin == Origin{OriginKind::hypothesis, ClosureId{0}} &&
               relation.a == its.scene.first[3] && relation.b == its.scene.second[3];
    return count;
  };
  EXPECT_EQ(taken_in(), 1);
  its.closures.forbid(its.world(), ClosureId{0}, true);
  its.take_outcomes();
  EXPECT_EQ(taken_in(), 0) << "it rests on the closure";
  EXPECT_EQ(its.pool.waiting(), 2U) << "nobody has forbidden it itself";
}

TEST(HypothesisPool, ReopensFindsOfARefusedMergeOnceTheyAreOfOneIsland) {
  Pooling its;
  its.believe_little();
  const auto decided = [&](const Pose& first_from_second) {
    for (const std::size_t i : {0U, 2U, 4U}) its.find(i, first_from_second);
    EXPECT_TRUE(its.propose());
    its.take_outcomes();
    return its.closures.closures().back().state;
  };
  ASSERT_EQ(decided({1.2, 0.6, 0}), ClosureState::refused);
  EXPECT_EQ(its.pool.waiting(), 0U);
  ASSERT_EQ(decided({0, 1.5, 0}), ClosureState::accepted);
  EXPECT_EQ(its.pool.waiting(), 3U) << "the question is another one now";
}

TEST(HypothesisPool, ReopensFindsOfARefusedLoopOnceTheMapThatRefusedItIsNoMore) {
  Pooling its;
  its.believe_little();
  const auto decided = [&](std::initializer_list<std::size_t> of, const Pose& first_from_second) {
    for (const std::size_t i : of) its.find(i, first_from_second);
    EXPECT_TRUE(its.propose());
    its.take_outcomes();
    return its.closures.closures().back().state;
  };
  ASSERT_EQ(decided({0, 2, 4}, {0, 1.5, 0}), ClosureState::accepted);
  ASSERT_EQ(decided({1, 3, 5}, {1.2, 0.6, 0}), ClosureState::refused);
  EXPECT_EQ(its.pool.waiting(), 0U);
  its.closures.forbid(its.world(), ClosureId{0}, true);
  its.take_outcomes();
  EXPECT_EQ(its.pool.waiting(), 3U);
}

TEST(HypothesisPool, KeepsAFindOnceHoweverOftenItIsMade) {
  Pooling its;
  its.find(0);
  its.find(0);
  EXPECT_EQ(its.counts.finds, 2);
  EXPECT_EQ(its.pool.waiting(), 1U);
}

// It was asked again as the map has changed, which says more by then.
TEST(HypothesisPool, KeepsOfAFindThatIsMadeAgainWhatItSaysTheSecondTime) {
  Pooling its;
  its.scene.join();
  its.find(0, {0, 1.5, 0}, 1, -1);
  its.find(4, {0, 1.5, 0}, 1, -1);
  EXPECT_FALSE(its.propose());
  its.find(0, {0, 1.5, 0}, 1, 3);
  EXPECT_EQ(its.pool.waiting(), 2U);
  EXPECT_TRUE(its.propose());
  its.take_outcomes();
  EXPECT_EQ(its.closures.closures().at(0).account.supporters, 2) << "that agree as they did";
}

TEST(HypothesisPool, LetsTheOldestFindGoWhenItIsFull) {
  Pooling its;
  its.scene.options.common.max_finds = 3;
  its.find(0, {0, 1.5, 0}, 9);
  for (const std::size_t i : {2U, 4U, 5U}) its.find(i, {0, 1.5, 0}, 4);
  EXPECT_EQ(its.pool.waiting(), 3U);
  ASSERT_TRUE(its.propose());
  its.take_outcomes();
  EXPECT_EQ(its.closures.closures()[0].account.look_alikes, 4) << "that of nine places is gone";
}

TEST(HypothesisPool, ProposesAgainOnlyWithMoreUnlessAllIsTriedAgain) {
  Pooling its;
  for (const std::size_t i : {0U, 2U, 4U}) its.find(i);
  ASSERT_TRUE(its.propose());
  its.closures.refuse_from_scans(ClosureId{0}, Reason::none);
  EXPECT_FALSE(its.propose());
  its.pool.try_all_again();
  EXPECT_TRUE(its.propose());
  EXPECT_EQ(its.closures.closures().size(), 1U) << "it is the same closure";
}

TEST(HypothesisPool, TellsWhatScansAloneDoNotDecide) {
  Pooling its;
  for (const std::size_t i : {0U, 2U, 4U}) its.find(i);
  ASSERT_TRUE(its.propose());
  EXPECT_TRUE(its.pool.undecided().empty()) << "it is on trial";
  its.take_outcomes();
  const std::vector<UndecidedHypothesis> undecided = its.pool.undecided();
  ASSERT_EQ(undecided.size(), 1U);
  EXPECT_EQ(undecided[0].id, ClosureId{0});
  EXPECT_EQ(undecided[0].first, its.scene.first[0]);
  EXPECT_EQ(undecided[0].second, its.scene.second[0]);
  EXPECT_EQ(undecided[0].first_from_second, (Pose{0, 1.5, 0}));
  EXPECT_GT(undecided[0].value, 0);
  EXPECT_EQ(its.pool.waiting(), 3U);
}

// Two robots may be on their way to meet because of it.
TEST(HypothesisPool, StaysUndecidedWhileItIsTriedAgain) {
  Pooling its;
  for (const std::size_t i : {0U, 2U, 4U}) its.find(i);
  ASSERT_TRUE(its.propose());
  its.take_outcomes();
  ASSERT_EQ(its.pool.undecided().size(), 1U);
  const double value = its.pool.undecided()[0].value;
  its.pool.try_all_again();
  ASSERT_TRUE(its.propose());
  ASSERT_EQ(its.pool.undecided().size(), 1U);
  EXPECT_EQ(its.pool.undecided()[0].value, value);
}

TEST(HypothesisPool, ForgetsFindsThatAreDecided) {
  Pooling its;
  its.believe_little();
  for (const std::size_t i : {0U, 2U, 4U}) its.find(i);
  ASSERT_TRUE(its.propose());
  its.take_outcomes();
  ASSERT_EQ(its.closures.closures()[0].state, ClosureState::accepted)
      << word(its.closures.closures()[0].reason);
  EXPECT_EQ(its.pool.waiting(), 0U);
}

TEST(HypothesisPool, HasFindsWaitAgainThatAreAllowedAgain) {
  Pooling its;
  its.believe_little();
  for (const std::size_t i : {0U, 2U, 4U}) its.find(i);
  ASSERT_TRUE(its.propose());
  its.take_outcomes();
  its.closures.forbid(its.world(), ClosureId{0}, true);
  its.take_outcomes();
  EXPECT_EQ(its.pool.waiting(), 0U);
  its.closures.allow(ClosureId{0});
  its.take_outcomes();
  EXPECT_EQ(its.pool.waiting(), 3U);
}

TEST(HypothesisPool, PassesOnWhatIsRefuted) {
  Pooling its;
  for (const std::size_t i : {0U, 2U, 4U}) its.find(i);
  ASSERT_TRUE(its.propose());
  its.pool.refute(ClosureId{0}, Reason::met_nobody);
  EXPECT_EQ(its.pool.waiting(), 0U);
  EXPECT_TRUE(its.closures.on_trial());
  its.pool.take_outcomes(its.world(), its.closures, its.counts);
  EXPECT_FALSE(its.closures.on_trial());
  EXPECT_EQ(its.closures.closures()[0].reason, Reason::met_nobody);
}

TEST(HypothesisPool, ForgetsFindsOfARobotsPatches) {
  Pooling its;
  its.find(0);
  its.pool.forget_robot(its.scene.map, "R3");
  EXPECT_EQ(its.pool.waiting(), 1U);
  its.pool.forget_robot(its.scene.map, "R2");
  EXPECT_EQ(its.pool.waiting(), 0U);
}

}  // namespace
}  // namespace isthmus
