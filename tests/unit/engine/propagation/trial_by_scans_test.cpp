// Each refusal of a trial by itself: every case below is accepted but for the one thing that it is named
// after.

#include "server/engine/propagation/trial.hpp"

#include <gtest/gtest.h>

#include "server/engine/propagation/trial_account.hpp"
#include "tests/unit/engine/propagation/trial_scenes.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

// A loop found so far from where the map had it, over so much way.
void found(Case& its, double off_m, double way_m = 60) {
  const PatchId anchor = its.first.back(), query = its.second.front();
  its.proposal.revisit = {anchor, query, its.map.relative_pose(anchor, query) * Pose{off_m, 0, 0}, way_m};
}

// A loop found where the map had it.
Case by_scans(Case made, int finds = 4) {
  made.proposal.from_scans = true;
  made.proposal.supporters = finds;
  if (!made.proposal.merge) found(made, 0);
  return made;
}

TEST(TrialByScans, OfALoopThatIsTrueIsAccepted) {
  Case its = by_scans(loop_of(crooked_room(), outward, crooked_room(), homeward));
  its.say(PatchId{1}, PatchId{4});
  const Trial trial = its.tried();
  EXPECT_TRUE(trial.accepted()) << word(trial.refusal());
  EXPECT_GE(trial.patches_touched(), 4);
}

// The two ways hung together by a loop that was closed before.
TEST(TrialByScans, OfALoopTellsByWhichOthersTheMapHadItsEnds) {
  Case its = by_scans(loop_of(crooked_room(), outward, crooked_room(), homeward));
  const PatchId a = its.first.back(), b = its.second.front();
  its.map.remove(its.map.graph().between(a, b));
  Relation earlier = sighting_tie(a, b, its.true_relative(a, b));
  earlier.origin = {OriginKind::hypothesis, ClosureId{7}};
  its.map.relate(earlier);
  its.say(PatchId{1}, PatchId{4});
  EXPECT_EQ(its.tried().account().rests_on, std::vector<ClosureId>{ClosureId{7}});
}

TEST(TrialByScans, WhoseFindsPullAtOneAnotherIsRefused) {
  Case its = by_scans(loop_of(crooked_room(), outward, crooked_room(), homeward));
  for (const double sign : {-1, 1}) its.say(PatchId{1}, PatchId{4}, {sign * 0.1, 0, 0});
  EXPECT_EQ(its.tried().refusal(), Reason::finds_disagree);
}

// A screen where the first way looked through says as much against it as next to many that match.
TEST(TrialByScans, OfALoopByFewPatchesThatMatchIsJudgedByAllOfItsOdds) {
  const Walls room = crooked_room();
  for (const bool screened : {false, true}) {
    Case its = by_scans(loop_of(room, {{-1.5, -0.4, 0.2}, {-1.6, -0.3, 0.1}},
                                screened ? with_a_screen(room) : room, {{-1.4, -0.3, 0.2}}));
    its.say(PatchId{1}, PatchId{2});
    const Trial trial = its.tried();
    EXPECT_GT(trial.account().compared, 0);
    EXPECT_LT(trial.account().matched, TrialOptions{}.few_matched_scans);
    EXPECT_EQ(trial.account().fit_log_odds < -1, screened) << trial.account().fit_log_odds;
    EXPECT_EQ(trial.accepted(), !screened) << word(trial.refusal());
  }
}

// One patch of either side: nothing of the map is new to the other but what the finds say.
TEST(TrialByScans, WithNothingToCompareIsJudgedByTheRestOfItsOdds) {
  for (const double off_m : {0.0, 200.0}) {
    Case its = by_scans(loop_of(crooked_room(), {outward[1]}, crooked_room(), {homeward[1]}));
    found(its, off_m);
    its.say(PatchId{0}, PatchId{1});
    const Trial trial = its.tried();
    EXPECT_EQ(trial.account().compared, 0);
    EXPECT_EQ(trial.accepted(), off_m == 0) << word(trial.refusal());
    EXPECT_EQ(trial.undecided(), off_m != 0);
  }
}

// Of a loop it is in the account, as ground on which nothing matches.
TEST(TrialByScans, WhoseScansDoNotMatchIsRefusedOfAMergeAndWaitsOfALoop) {
  Walls plain;
  add_box(plain, -4, -3, 4, 3);
  for (const bool merge : {false, true}) {
    Case its = by_scans(merge ? merge_of(plain, outward, toothed_room(), homeward)
                              : loop_of(plain, outward, toothed_room(), homeward));
    its.say(PatchId{1}, PatchId{4});
    const Trial trial = its.tried();
    EXPECT_FALSE(trial.accepted());
    EXPECT_EQ(trial.undecided(), !merge);
    EXPECT_EQ(trial.refusal() == Reason::scans_disagree, merge) << word(trial.refusal());
    EXPECT_EQ(trial.account().matched, 0);
    EXPECT_EQ(trial.account().shared_log_odds < -1, !merge) << trial.account().shared_log_odds;
  }
}

const std::vector<Pose> early_way = {{-1.5, -0.4, 0.2}, {-1.6, -0.3, 0.1}, {-1.7, -0.5, 0}};
const std::vector<Pose> late_way = {{-1.4, -0.3, 0.2}, {-1.5, -0.5, 0.1}, {-1.6, -0.4, 0.3}};

TEST(TrialByScans, ThatPutsWallsInFreeSpaceIsRefusedOrWaitsWhereTheMapHadItsEnds) {
  const Walls room = crooked_room();
  for (const double off_m : {0.0, 200.0}) {
    Case its = by_scans(loop_of(room, early_way, with_a_screen(room), late_way));
    found(its, off_m);
    if (off_m > 0) its.proposal.prior_log_odds = -1;
    its.say(PatchId{1}, PatchId{4});
    const Trial trial = its.tried();
    EXPECT_FALSE(trial.accepted()) << trial.account().log_odds();
    EXPECT_EQ(trial.undecided(), off_m == 0);
    EXPECT_EQ(trial.refusal() == Reason::walls_in_free_space, off_m > 0) << word(trial.refusal());
    EXPECT_LT(trial.account().fit_log_odds, -3);
  }
}

// Somebody who came and went: as much as a map contradicts itself, maps may contradict one another.
TEST(TrialByScans, MayContradictAsMuchAsTheMapsContradictThemselves) {
  const Walls without = crooked_room(), with = with_a_screen(without);
  Case its = by_scans(
      loop_of(std::vector{with, without, with}, early_way, std::vector{without, with, without}, late_way));
  found(its, 0, 300);
  its.say(PatchId{1}, PatchId{4});
  const Trial trial = its.tried();
  EXPECT_TRUE(trial.accepted()) << word(trial.refusal());
}

// A corridor of uneven niches, so that every metre of it is known from every other.
Walls long_corridor() {
  Walls walls = corridor();
  double x = -10;
  for (int i = 0; x < 60; ++i, x += 0.7 + 0.13 * (i * i % 7)) {
    const double side = i % 3 == 0 ? -1 : 0.75;
    add_box(walls, x, side, x + 0.3 + 0.05 * (i % 4), side + 0.25);
  }
  return walls;
}

std::vector<Pose> along(double from_x, double to_x, double y, double step_m = 1) {
  std::vector<Pose> poses;
  for (double x = from_x; x <= to_x; x += step_m) poses.push_back({x, y, 0});
  return poses;
}

// What pulls at one another, if not by so much that it is refused at once, needs more of the rest.
TEST(TrialByScans, WhoseFindsPullAtOneAnotherNeedsMoreThatSpeaksForIt) {
  for (const double off_m : {0.0, 0.03}) {
    Case its = by_scans(loop_of(long_corridor(), along(0, 11, 0), long_corridor(), along(0.3, 11, 0.1)));
    its.say(PatchId{5}, PatchId{17}, {off_m, 0, 0});
    its.say(PatchId{5}, PatchId{17}, {-off_m, 0, 0});
    const Trial trial = its.tried();
    EXPECT_EQ(trial.accepted(), off_m == 0) << trial.account().log_odds() << ' ' << trial.account().cost;
    EXPECT_LT(trial.account().cost, TrialOptions{}.max_find_cost);
  }
}

// A few relations may cost much because a patch lies crooked by itself: what most of them cost tells.
TEST(TrialByScans, WithAFewRelationsThatFitBadlyIsAsGoodAsTheMostOfThem) {
  for (const int crooked : {1, 4}) {
    Case its = by_scans(loop_of(long_corridor(), along(0, 11, 0), long_corridor(), along(0.3, 11, 0.1)));
    for (int i = 0; i < 5; ++i)
      its.say(PatchId{2 + 2 * i}, PatchId{14 + 2 * i},
              {i < crooked ? 0.15 * (i % 2 == 0 ? 1 : -1) : 0, 0, 0});
    const Trial trial = its.tried();
    EXPECT_EQ(trial.account().cost < TrialOptions{}.even_find_cost, crooked == 1) << trial.account().cost;
    EXPECT_EQ(trial.accepted(), crooked == 1) << word(trial.refusal());
  }
}

// |===================|    Ten metres of one corridor, driven twice: corridors look alike.
//    1  2  3 ... 10
// |===================|
TEST(TrialByScans, OfALoopAlongOneCorridorWaitsWhereTheMapHadItsEndsElsewhere) {
  for (const bool cautious : {false, true}) {
    Case its = by_scans(loop_of(long_corridor(), along(0, 11, 0), long_corridor(), along(0.3, 11, 0.1)));
    its.proposal.cautious = cautious;
    found(its, 200);
    its.say(PatchId{5}, PatchId{17});
    const Trial trial = its.tried();
    EXPECT_GE(trial.patches_touched(), 12);
    EXPECT_EQ(trial.refusal(), Reason::one_corridor) << "however sure the map was";
    EXPECT_TRUE(trial.undecided());
  }
}

// The same, found where the map had it: another corridor that looks alike would hardly lie just there.
TEST(TrialByScans, OfALoopAlongOneCorridorIsAcceptedWhereTheMapHadItsEnds) {
  for (const double off_m : {0.0, 200.0}) {
    Case its = by_scans(loop_of(long_corridor(), along(0, 11, 0), long_corridor(), along(0.3, 11, 0.1)));
    found(its, off_m);
    its.say(PatchId{5}, PatchId{17});
    const Trial trial = its.tried();
    EXPECT_EQ(trial.accepted(), off_m == 0) << word(trial.refusal());
  }
}

TEST(TrialByScans, OfALoopNeedsAsMuchMoreAsItWasLessSureBefore) {
  Case its = by_scans(loop_of(long_corridor(), along(0, 11, 0), long_corridor(), along(0.3, 11, 0.1)));
  found(its, 0);
  its.say(PatchId{5}, PatchId{17});
  const TrialAccount agreed = its.tried().account();
  const double asked = TrialOptions{}.min_loop_log_odds - (agreed.log_odds() - agreed.prior_log_odds);
  for (const double more : {-0.1, 0.1}) {
    its.proposal.prior_log_odds = asked + more;
    const Trial trial = its.tried();
    EXPECT_EQ(trial.accepted(), more > 0) << word(trial.refusal());
    EXPECT_EQ(trial.undecided(), more < 0);
  }
}

// A hall that the map has twice, the second time turned aside.
TEST(TrialByScans, OfALoopThatIsNearlySureEnoughIsAcceptedWhereTheMapHadOnePlaceTwice) {
  for (const bool twice : {false, true}) {
    Case its = by_scans(loop_of(niched_hall(), along(0, 11, 0), niched_hall(), along(0.3, 11, 0.3)));
    its.say(PatchId{5}, PatchId{17});
    std::vector<Pose> poses(its.map.manifold().poses().begin(), its.map.manifold().poses().end());
    if (twice)
      for (const PatchId id : its.second) poses[index(id)] = Pose{5, -5, 1.57} * poses[index(id)];
    its.map.adopt(its.second, poses);
    its.proposal.beyond_covariance = {100, 100, 10};
    const double sum = its.tried().account().log_odds() - its.tried().account().layers_log_odds;
    its.proposal.prior_log_odds += TrialOptions{}.min_loop_log_odds - 0.5 - sum;
    const Trial trial = its.tried();
    EXPECT_EQ(trial.accepted(), twice) << word(trial.refusal());
    EXPECT_EQ(trial.undecided(), !twice);
    EXPECT_EQ(trial.account().layers_before >= 10, twice) << trial.account().layers_before;
    EXPECT_LE(trial.account().layers_after, 2);
  }
}

// What lies beyond the place that looks alike comes to lie over other rooms than its own.
TEST(TrialByScans, OfALoopThatIsBarelySureEnoughWaitsWhereItDrawsTwoPlacesOverOneAnother) {
  for (const bool over : {false, true}) {
    std::vector<Pose> way = along(0.3, 11, 0.3);
    std::vector<Walls> seen(way.size(), niched_hall());
    for (const Pose& back : along(0.3, 11, 0.6)) {
      way.push_back(back);
      seen.push_back(over ? Walls{{{-100, -0.2}, {100, -0.1}}, {{-100, 1.3}, {100, 1.2}}} : niched_hall());
    }
    Case its = by_scans(loop_of(std::vector<Walls>(12, niched_hall()), along(0, 11, 0), seen, way));
    its.say(PatchId{5}, PatchId{17});
    std::vector<Pose> poses(its.map.manifold().poses().begin(), its.map.manifold().poses().end());
    for (const PatchId id : its.second) poses[index(id)] = Pose{500, 0, 0} * poses[index(id)];
    its.map.adopt(its.second, poses);
    its.proposal.beyond_covariance = {1e6, 1e6, 10};
    const double sum = its.tried().account().log_odds() - its.tried().account().layers_log_odds;
    its.proposal.prior_log_odds += TrialOptions{}.min_loop_log_odds + 0.5 - sum;
    const Trial trial = its.tried();
    EXPECT_EQ(trial.undecided(), over) << word(trial.refusal());
    EXPECT_EQ(trial.accepted(), !over);
    EXPECT_EQ(trial.account().layers_after > trial.account().layers_before + 20, over);
  }
}

// However far it matches: a corridor that repeats itself does so from end to end.
TEST(TrialByScans, OfALoopAlongACorridorSaysNoMoreThanHowSeldomCorridorsRepeatThemselves) {
  Case its = by_scans(loop_of(long_corridor(), along(0, 31, 0), long_corridor(), along(0.3, 31, 0.1)));
  found(its, 0);
  its.say(PatchId{5}, PatchId{37});
  const TrialAccount account = its.tried().account();
  EXPECT_GT(account.way_m, 20);
  const double by_way = account.shared_log_odds - account.width_m;
  EXPECT_LT(by_way, -std::log(TrialOptions{}.repeats_probability));
  EXPECT_GT(by_way, 4) << "and next to all of that";
}

// Nor across: wings repeat one another, with all corridors of theirs.
TEST(TrialByScans, OfALoopSaysNoMoreThanHowSeldomWhatLiesAcrossRepeatsItself) {
  Case its = by_scans(loop_of(niched_hall(), along(0, 11, 0), niched_hall(), along(0.3, 11, 0.3)));
  its.say(PatchId{5}, PatchId{17});
  its.proposal.look_alikes = 2;
  EngineOptions wide;
  wide.trial.log_odds_per_width_m = 1000;
  const TrialAccount account = its.tried(wide).account();
  ASSERT_GT(account.width_m, 0.02);
  const double most = -std::log(wide.trial.repeats_probability);
  EXPECT_LE(account.shared_log_odds, most + 1e-9);
  EXPECT_GT(account.shared_log_odds, most - 0.1);
}

// What it matches along the way has told the places apart already, and is not counted twice.
TEST(TrialByScans, OfALoopFoundAtOneOfSeveralPlacesNeedsMoreThanItsWay) {
  for (const bool one_of_several : {false, true}) {
    Case its = by_scans(loop_of(long_corridor(), along(0, 11, 0), long_corridor(), along(0.3, 11, 0.1)));
    found(its, 0, 30);
    its.proposal.look_alikes = one_of_several ? 2 : 1;
    its.say(PatchId{5}, PatchId{17});
    const Trial trial = its.tried();
    EXPECT_EQ(trial.accepted(), !one_of_several) << word(trial.refusal());
    EXPECT_EQ(trial.undecided(), one_of_several);
  }
}

std::vector<Walls> where_robots_were(std::size_t patches) {
  return std::vector<Walls>(patches, long_corridor());
}

// From 6 m on it is a narrow place the second time.
TEST(TrialByScans, OfALoopIsTheLessLikelyTheMoreOfTheGroundDoesNotMatch) {
  std::vector<Walls> seen = where_robots_were(11);
  std::fill(seen.begin() + 6, seen.end(), Walls{{{-100, -0.2}, {100, -0.1}}, {{-100, 0.7}, {100, 0.6}}});
  Case its = by_scans(loop_of(where_robots_were(12), along(0, 11, 0.3), seen, along(0.3, 11, 0.3)));
  found(its, 0);
  its.say(PatchId{3}, PatchId{15});
  EngineOptions none;
  none.trial.log_odds_per_unmatched_m = 0;
  const TrialAccount account = its.tried().account(), without = its.tried(none).account();
  ASSERT_GT(account.unmatched_m, 0);
  EXPECT_NEAR(without.shared_log_odds - account.shared_log_odds,
              TrialOptions{}.log_odds_per_unmatched_m * account.unmatched_m, 1e-9);
}

// Somebody in the way, a scan as the robot turns: what lies there matches as others saw it.
TEST(TrialByScans, OfALoopScansThatDoNotMatchAmidOthersThatDoSayNothing) {
  std::vector<Walls> seen = where_robots_were(11);
  for (const std::size_t i : {3U, 6U}) {
    const double x = static_cast<double>(i);
    seen[i] = {{{x - 0.6, -1}, {x - 0.2, 1}}, {{x + 0.8, -1}, {x + 1.2, 1}}};
  }
  Case its = by_scans(loop_of(where_robots_were(12), along(0, 11, 0.3), seen, along(0.3, 11, 0.3)));
  found(its, 0);
  its.say(PatchId{3}, PatchId{15});
  const TrialAccount account = its.tried().account();
  ASSERT_GT(account.compared, account.matched);
  EXPECT_EQ(account.unmatched_m, 0);
}

// As likely as each of the others, but for where the map had them.
TEST(TrialByScans, OfALoopIsTheLessLikelyTheMorePlacesLookAlike) {
  std::vector<double> log_odds;
  for (const int look_alikes : {1, 2, 28}) {
    Case its = by_scans(loop_of(long_corridor(), along(0, 11, 0), long_corridor(), along(0.3, 11, 0.1)));
    found(its, 0, 30);
    its.proposal.look_alikes = look_alikes;
    its.say(PatchId{5}, PatchId{17});
    const Trial trial = its.tried();
    EXPECT_EQ(trial.account().look_alikes, look_alikes);
    log_odds.push_back(trial.account().revisit_log_odds);
  }
  EXPECT_NEAR(log_odds[0] - log_odds[1], std::log(2), 1e-9);
  EXPECT_NEAR(log_odds[0] - log_odds[2], std::log(28), 1e-9);
}

// Ten patches over twenty metres: few, however far apart.
// Before it is measured what the two share, which takes the longer the larger they are.
TEST(TrialByScans, OfAMergeByFewPatchesWaits) {
  for (const double stride_m : {5.0, 14.0}) {
    Case its = by_scans(
        merge_of(long_corridor(), along(0, 30, 0, stride_m), long_corridor(), along(9, 40, 0.1, stride_m)));
    its.say(its.first.back(), its.second.front());
    const Trial trial = its.tried();
    EXPECT_LT(trial.patches_touched(), 12);
    EXPECT_EQ(trial.refusal(), Reason::too_little_support);
    const bool few = trial.account().matched < TrialOptions{}.few_matched_scans;
    EXPECT_EQ(few, stride_m > 5) << trial.account().matched;
    EXPECT_EQ(trial.account().own_m > 0, !few);
  }
}

Case merge_along(double first_from, double first_to, double second_from, double second_to,
                 const Walls& of_second) {
  Case its = by_scans(merge_of(long_corridor(), along(first_from, first_to, 0), of_second,
                               along(second_from, second_to, 0.1)));
  // Where both are in the middle of what they share.
  const double middle = 0.5 * (std::max(first_from, second_from) + std::min(first_to, second_to));
  const auto nearest = [&](const std::vector<PatchId>& way) {
    return *std::ranges::min_element(way, {}, [&](PatchId id) { return std::abs(its.truth(id).x - middle); });
  };
  its.say(nearest(its.first), nearest(its.second));
  return its;
}

//    1 --------------------------------          What they share is long, and each goes on beyond it.
//                    ---------------------- 2
TEST(TrialByScans, OfAMergeThatSharesMuchAndGoesOnIsAccepted) {
  const Trial trial = merge_along(0, 40, 16.3, 56, long_corridor()).tried();
  EXPECT_TRUE(trial.accepted()) << word(trial.refusal());
}

TEST(TrialByScans, SaysByWhatItWasJudged) {
  const Trial trial = merge_along(0, 40, 16.3, 56, long_corridor()).tried();
  const TrialAccount& account = trial.account();
  EXPECT_EQ(account.matched, trial.patches_touched());
  EXPECT_GE(account.compared, account.matched);
  EXPECT_GT(account.supporters, 0);
  EXPECT_LT(account.cost, 1);
  EXPECT_LT(account.contradiction, 0.05);
  EXPECT_NEAR(account.way_m, 24, 8) << "16.3 to 40 m, and what overlaps beyond";
  EXPECT_LT(account.width_m, 2);
  EXPECT_NEAR(account.shared_log_odds, 0.4 * account.way_m + account.width_m, 1e-9);
}

TEST(TrialByScans, OfAMergeThatSharesLittleWaits) {
  const Trial trial = merge_along(0, 17, 9.3, 30, long_corridor()).tried();
  EXPECT_TRUE(trial.undecided());
  EXPECT_GE(trial.patches_touched(), 8);
  EXPECT_EQ(trial.refusal(), Reason::too_little_support);
}

TEST(TrialByScans, OfAMergeWithNothingBeyondWhatIsSharedWaits) {
  const Trial trial = merge_along(10, 32, 10.3, 41, long_corridor()).tried();
  EXPECT_TRUE(trial.undecided());
  EXPECT_EQ(trial.refusal(), Reason::nothing_beyond_the_seam);
}

// So much of a building does not look alike by chance: it is looked at as far as it matches, however many
// patches would do for a loop.
TEST(TrialByScans, OfAMergeOfTwoMapsOfTheSameWholeIsAcceptedWhereThatIsLarge) {
  EngineOptions options;
  options.trial.max_matched_scans = 20;
  const Trial trial = merge_along(0, 80, 0.3, 84, long_corridor()).tried(options);
  EXPECT_GT(trial.account().way_m, 62.5);
  EXPECT_TRUE(trial.accepted()) << word(trial.refusal());
}

// Beyond what they share, the second way saw a hall where the first saw the corridor go on.
Walls corridor_into_a_hall() {
  Walls walls = long_corridor();
  std::erase_if(walls, [](const Wall2d& wall) { return std::max(wall.first.x(), wall.second.x()) > 34; });
  walls.insert(walls.end(), {{{-100, -1}, {34, -1}},
                             {{-100, 1}, {34, 1}},
                             {{34, -1}, {34, -4}},
                             {{34, 1}, {34, 4}},
                             {{34, -4}, {60, -4}},
                             {{34, 4}, {60, 4}}});
  return walls;
}

TEST(TrialByScans, OfAMergeWhoseMapsContradictOneAnotherAtTheBorderIsRefused) {
  const Trial trial = merge_along(0, 40, 10.3, 44, corridor_into_a_hall()).tried();
  EXPECT_EQ(trial.refusal(), Reason::walls_in_free_space);
}

}  // namespace
}  // namespace isthmus
