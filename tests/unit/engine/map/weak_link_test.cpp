#include "server/engine/map/weak_link.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "relations/fit.hpp"
#include "tests/support/ways.hpp"

namespace isthmus {
namespace {

using testing::odometry_relation;

/// A way round a square of 4 m, a patch each metre, each tied to the two before it by matches:
///
///     12 11 10  9  8
///     13           7
///     14     <--   6      15 comes to lie beside 0, where it began: the loop
///     15           5
///      0  1  2  3  4
struct Square {
  std::vector<Pose> truth;
  RelationGraph graph;
  std::vector<Pose> poses;  ///< as the map has them, without the loop
  Reach reach;

  /// The scan of patch `slipped` was placed so far from where it was, odometry or not.
  explicit Square(int slipped = -1, const Pose& slip = {}, const Pose& drift = {}, bool wheels_too = false) {
    for (int side = 0; side < 4; ++side)
      for (int i = 0; i < 4; ++i) {
        const Pose corner =
            truth.empty() ? Pose{} : truth.back() * Pose{1, 0, i == 0 ? std::numbers::pi / 2 : 0};
        truth.push_back(corner);
      }
    for (int i = 0; i < 16; ++i) {
      graph.add_patch(PatchId{i});
      poses.push_back(i == 0 ? Pose{}
                             : poses.back() * step(i - 1, i) * (i == slipped ? slip : Pose{}) * drift);
      if (i == 0) continue;
      const Pose told = wheels_too ? ominus(poses[at(i)], poses[at(i - 1)]) : step(i - 1, i);
      graph.add(odometry_relation(PatchId{i - 1}, PatchId{i}, told, {10, 10, 10}));
      graph.add(match(i - 1, i));
      if (i > 1 && i != slipped && i != slipped + 1) graph.add(match(i - 2, i));
    }
  }
  /// One robot made the way, a patch every so many seconds.
  void take_s(double seconds, double max_speed_m_per_s) {
    reach = {{}, max_speed_m_per_s, 0.5};
    for (int i = 0; i < 16; ++i) {
      auto patch = std::make_shared<Patch>();
      patch->robot = "R1";
      patch->utime = static_cast<std::int64_t>(i * seconds * 1e6);
      reach.patches.push_back(std::move(patch));
    }
  }
  Pose step(int a, int b) const { return ominus(truth[at(b)], truth[at(a)]); }
  Relation match(int a, int b) const {
    Relation relation =
        odometry_relation(PatchId{a}, PatchId{b}, ominus(poses[at(b)], poses[at(a)]), {2500, 2500, 10000});
    relation.origin = {OriginKind::match, {}};
    return relation;
  }
  /// What is to blame if patch 15 lies by patch 0 where it truly does.
  std::optional<Blame> closed(double max_log_odds = 100, const WeakLinkOptions& options = {},
                              const std::vector<UncertainClosure>& closed_before = {}) const {
    RelationGraph with = graph;
    Relation closure = odometry_relation(PatchId{0}, PatchId{15}, step(0, 15), {2500, 2500, 10000});
    closure.origin = {OriginKind::hypothesis, ClosureId{0}};
    with.add(closure);
    std::vector<Pose> fitted = poses;
    const FitReport report = fit_island(with, IslandId{PatchId{0}}, fitted);
    const OpenLoop loop{{PatchId{0}}, {PatchId{15}}, truth[15] * inverse(poses[15]), 15, closed_before};
    return blame({loop, graph, poses, with, report.cost_after, max_log_odds, std::log(1000), reach}, options);
  }

  static std::size_t at(int patch) { return static_cast<std::size_t>(patch); }
};

TEST(WeakLink, IsThePlacingAtWhichTheRobotSlipped) {
  const Square square(6, {0.3, 0.2, 0.6});
  const auto found = square.closed();
  ASSERT_TRUE(found);
  EXPECT_EQ(found->link.beyond.front(), PatchId{6});
  EXPECT_EQ(found->link.beyond.size(), 10U);
  EXPECT_LT(found->link.log_odds, WeakLinkOptions{}.match_log_odds + WeakLinkOptions{}.odometry_log_odds)
      << "odometry says otherwise";
  EXPECT_EQ(found->wrong.size(), 1U) << "odometry was right";
  for (int i = 0; i < 16; ++i) {
    const Pose off = ominus(found->poses[Square::at(i)], square.truth[Square::at(i)]);
    EXPECT_LT(std::hypot(off.x, off.y), 0.05) << i;
  }
}

/// Somebody has taken patch 12 for a place beside patch 3, a metre and more from where it truly is.
Square bent_by(ClosureId wrong) {
  Square square;
  for (const int beside : {3, 4}) {
    Relation relation = odometry_relation(PatchId{beside}, PatchId{12},
                                          square.step(beside, 12) * Pose{1, 0.5, 0.3}, {2500, 2500, 10000});
    relation.origin = {OriginKind::hypothesis, wrong};
    square.graph.add(relation);
  }
  fit_island(square.graph, IslandId{PatchId{0}}, square.poses);
  return square;
}

TEST(WeakLink, IsALoopThatWasClosedWronglyBeforeWhereThatExplainsMore) {
  const ClosureId wrong{7};
  const auto found = bent_by(wrong).closed(100, {}, {{wrong, 3}});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->closure, wrong);
  EXPECT_EQ(found->log_odds, 3);
  EXPECT_EQ(found->wrong.size(), 2U) << "all that it says, and no link of the way";
  const Square square;
  for (int i = 0; i < 16; ++i) {
    const Pose off = ominus(found->poses[Square::at(i)], square.truth[Square::at(i)]);
    EXPECT_LT(std::hypot(off.x, off.y), 0.05) << i;
  }
}

// However many relations it has, each of which costs a little: a loop that was right has none of the blame
// for a way that drifted.
TEST(WeakLink, IsNoEarlierLoopForTheNoiseOfAllThatItSaid) {
  const ClosureId right{7};
  Square drifted(-1, {}, {0.01, 0.01, 0.01});
  for (int i = 0; i < 200; ++i) {
    Relation relation = odometry_relation(
        PatchId{3}, PatchId{5},
        ominus(drifted.poses[5], drifted.poses[3]) * Pose{i % 2 == 0 ? 0.015 : -0.015, 0, 0},
        {2500, 2500, 10000});
    relation.origin = {OriginKind::hypothesis, right};
    drifted.graph.add(relation);
  }
  WeakLinkOptions no_link;
  no_link.match_log_odds = no_link.odometry_log_odds = 1e6;
  EXPECT_FALSE(drifted.closed(100, no_link, {{right, 8}}));
}

TEST(WeakLink, IsNoEarlierLoopThatIsSurerThanThatSomethingSlippedThatNobodyKnowsThePlaceOf) {
  const ClosureId wrong{7};
  EXPECT_TRUE(bent_by(wrong).closed(3.5, {}, {{wrong, 3}})->closure.valid());
  const auto found = bent_by(wrong).closed(2.5, {}, {{wrong, 3}});
  EXPECT_FALSE(found && found->closure.valid());
}

// That one of four is wrong is as likely as all of them together.
TEST(WeakLink, IsNoEarlierLoopForCertainWhereAnyOfThemMayBeWrong) {
  const ClosureId wrong{7};
  const auto found =
      bent_by(wrong).closed(100, {}, {{wrong, 3}, {ClosureId{8}, 3}, {ClosureId{9}, 3}, {ClosureId{10}, 20}});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->closure, wrong);
  EXPECT_EQ(found->log_odds, 3);
  EXPECT_NEAR(found->none_log_odds, 3 - std::log(3), 1e-6);
}

TEST(WeakLink, IsNoEarlierLoopThatIsSurerThanWhatItWouldExplain) {
  const ClosureId right{7};
  const auto found = bent_by(right).closed(1e6, {}, {{right, 1e5}});
  EXPECT_FALSE(found && found->closure.valid());
}

// What all links err by a little, no link is to blame for.
TEST(WeakLink, IsNoneWhereTheWholeWayDriftedALittle) {
  EXPECT_FALSE(Square(-1, {}, {0.003, 0.002, 0.001}).closed());
}

// The surer a placing, the more has to speak against it.
TEST(WeakLink, IsNoneThatIsSurerThanWhatTheLoopCosts) {
  const Square square(6, {0.3, 0.2, 0.6});
  WeakLinkOptions sure;
  sure.match_log_odds = sure.odometry_log_odds = 1e6;
  EXPECT_FALSE(square.closed(1e9, sure));
  EXPECT_FALSE(square.closed(5)) << "than the drift of all the way would be";
}

// By Cauchy's distribution in the plane (1 m) and around the circle (0.2 rad), of which the window is 1,000
// m² rad.
TEST(WeakLink, IsTheSurerTheFartherOffItWouldHaveToBe) {
  const WeakLinkOptions options;
  const auto near = Square(6, {0.3, 0.2, 0.6}).closed(1e9);
  ASSERT_TRUE(near);
  const double of_odometry = options.odometry_log_odds - 0.5 * 10 * (0.09 + 0.04 + 0.36);
  EXPECT_NEAR(near->log_odds, options.match_log_odds + of_odometry, 0.01)
      << "slips of a metre are as likely as anything";
  const Square square(6, {300, 400, 0});
  const auto far = square.closed(1e9);
  ASSERT_TRUE(far);
  const double in_plane = 1 / (2 * std::numbers::pi * std::pow(500, 3));
  const double slip_rad = 1.0 / 6;
  const double of_yaw = std::sinh(slip_rad) / (2 * std::numbers::pi * (std::cosh(slip_rad) - 1));
  EXPECT_NEAR(far->log_odds, options.match_log_odds - std::log(1000 * in_plane * of_yaw), 0.01)
      << "odometry, which would be right then, says nothing against it";
  EXPECT_FALSE(square.closed(options.match_log_odds + 1)) << "though the link by itself is no surer";
}

// Five patches in a row, and the last lies half a metre beside where the map has it. Any of the four links
// may be off by so much, or only that in whose time a robot gets so far.
TEST(WeakLink, IsAsLikelyAsThatAnyLinkIsOffBySoMuch) {
  RelationGraph graph;
  std::vector<Pose> poses;
  Reach reach{{}, 0.1, 0.3};
  for (int i = 0; i < 5; ++i) {
    graph.add_patch(PatchId{i});
    poses.push_back({1.0 * i, 0, 0});
    if (i == 0) continue;
    for (const OriginKind kind : {OriginKind::odometry, OriginKind::match}) {
      Relation link = odometry_relation(PatchId{i - 1}, PatchId{i}, {1, 0, 0}, {2500, 2500, 10000});
      link.origin = {kind, {}};
      graph.add(link);
    }
  }
  RelationGraph with = graph;
  with.add(odometry_relation(PatchId{0}, PatchId{4}, {4, 0.5, 0}, {2500, 2500, 10000}));
  std::vector<Pose> fitted = poses;
  const FitReport report = fit_island(with, IslandId{PatchId{0}}, fitted);
  const OpenLoop loop{{PatchId{0}}, {PatchId{4}}, {0, 0.5, 0}, 4};
  const auto blamed = [&] {
    return blame({loop, graph, poses, with, report.cost_after, 1e9, std::log(1000), reach}, {});
  };
  const auto any = blamed();
  ASSERT_TRUE(any);
  EXPECT_NEAR(any->none_log_odds, any->log_odds - std::log(4), 0.01);
  for (const int after_s : {0, 1, 100, 101, 102}) {
    auto patch = std::make_shared<Patch>();
    patch->robot = "R1";
    patch->utime = after_s * 1'000'000;
    reach.patches.push_back(std::move(patch));
  }
  const auto one = blamed();
  ASSERT_TRUE(one);
  EXPECT_EQ(one->link.beyond.front(), PatchId{2});
  EXPECT_EQ(one->none_log_odds, one->log_odds);
}

// A place that looks alike lies 50 m from where the robot is: what it left no link may be wrong by.
TEST(WeakLink, IsNoneThatRobotsAreTooSlowFor) {
  Square square;
  for (int i = 6; i < 16; ++i) square.truth[Square::at(i)] = Pose{30, 40, 0} * square.truth[Square::at(i)];
  const auto found_after_s = [&](double seconds, double max_speed_m_per_s) {
    square.take_s(seconds, max_speed_m_per_s);
    return square.closed(1e5).has_value();
  };
  EXPECT_TRUE(square.closed(1e5)) << "where nothing is known of robots";
  EXPECT_TRUE(found_after_s(11, 5)) << "carried, or driven without a word";
  EXPECT_FALSE(found_after_s(9, 5));
  EXPECT_TRUE(found_after_s(9, 6));
}

TEST(Reach, IsTheSameEitherWayAndWithoutBoundAmongRobots) {
  Square square;
  square.take_s(2, 1.5);
  EXPECT_NEAR(square.reach.between_m(PatchId{3}, PatchId{5}), 0.5 + 4 * 1.5, 1e-9);
  EXPECT_NEAR(square.reach.between_m(PatchId{5}, PatchId{3}), 0.5 + 4 * 1.5, 1e-9);
  auto other = std::make_shared<Patch>();
  other->robot = "R2";
  square.reach.patches[5] = std::move(other);
  EXPECT_TRUE(std::isinf(square.reach.between_m(PatchId{3}, PatchId{5})));
  EXPECT_TRUE(std::isinf(Reach{}.between_m(PatchId{3}, PatchId{5})));
}

// Where nothing else tells the links of a way apart, that is to blame which has to move least: at the pole of
// the rotation that closes the loop it only has to turn.
TEST(WeakLink, IsWhereTheMapOnlyHasToTurn) {
  for (const int slipped : {3, 7, 11}) {
    const auto found = Square(slipped, {0, 0, 0.6}, {}, true).closed(1e9);
    ASSERT_TRUE(found) << slipped;
    EXPECT_EQ(found->link.beyond.front(), PatchId{slipped});
    EXPECT_EQ(found->link.beyond.size(), static_cast<std::size_t>(16 - slipped));
  }
}

TEST(WeakLink, TellsThePlacingOfAScanFromWhatWasMatchedLater) {
  Square square;
  square.graph.add(square.match(3, 9));
  const std::vector<UncertainLink> links =
      uncertain_links(square.graph, IslandId{PatchId{0}}, square.poses, {});
  ASSERT_EQ(links.size(), square.graph.relations().size());
  EXPECT_FALSE(links[0].of_placing) << "odometry, a mistake of its own";
  EXPECT_TRUE(links[1].of_placing);
  EXPECT_EQ(links[1].b, PatchId{1});
  EXPECT_FALSE(links.back().of_placing) << "long after either patch was placed";
}

}  // namespace
}  // namespace isthmus
