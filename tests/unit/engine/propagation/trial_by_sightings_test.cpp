// Each refusal of a trial by itself: every case below is accepted but for the one thing that it is named
// after.

#include "server/engine/propagation/trial.hpp"

#include <gtest/gtest.h>

#include "server/engine/propagation/trial_account.hpp"
#include "tests/unit/engine/propagation/trial_scenes.hpp"

namespace isthmus {
namespace {

using namespace isthmus::testing;

TEST(TrialBySightings, OfWhatIsTrueIsAccepted) {
  Case its = merge_of(crooked_room(), outward, crooked_room(), homeward);
  its.say(PatchId{1}, PatchId{4});
  const Trial trial = its.tried();
  EXPECT_TRUE(trial.accepted()) << word(trial.refusal());
  EXPECT_GE(trial.patches_touched(), 3) << "the scans bear it out";
  trial.commit(its.map);
  EXPECT_EQ(its.map.graph().islands().size(), 1U);
}

// What is near comes to its place by the first fit, and by matches what is not.
TEST(TrialBySightings, OfALoopFitsAgainAsMoreMatchesOnlyWhereItWasOpenByMuch) {
  for (const double link_sigma_m : {1.0, 20.0}) {
    Case its = loop_of(crooked_room(), outward, crooked_room(), homeward, link_sigma_m);
    its.say(PatchId{1}, PatchId{4});
    const Trial trial = its.tried();
    EXPECT_TRUE(trial.accepted()) << word(trial.refusal());
    EXPECT_GE(trial.account().matched, 1);
    if (link_sigma_m < SurroundingsOptions{}.reach_m)
      EXPECT_EQ(trial.fits(), 1);
    else
      EXPECT_GT(trial.fits(), 1);
  }
}

// The rest is matched where robots come; but what was far from its place comes there by matches alone.
TEST(TrialBySightings, OfALoopMatchesNoMoreThanTellsEnoughUnlessItWasOpenByMuch) {
  EngineOptions options;
  options.trial.max_matched_scans = 1;
  for (const double link_sigma_m : {1.0, 20.0}) {
    Case its = loop_of(crooked_room(), outward, crooked_room(), homeward, link_sigma_m);
    its.say(PatchId{1}, PatchId{4});
    const Trial trial = its.tried(options);
    EXPECT_TRUE(trial.accepted()) << word(trial.refusal());
    if (link_sigma_m < SurroundingsOptions{}.reach_m)
      EXPECT_EQ(trial.account().matched, 1);
    else
      EXPECT_GT(trial.account().matched, 1);
  }
}

// The ways lie where they truly do, and one half of the sightings pulls against the other.
TEST(TrialBySightings, ThatPullAtOneAnotherIsRefused) {
  for (const double off_m : {0.0, 0.06}) {
    Case its = merge_of(crooked_room(), outward, crooked_room(), homeward);
    for (const double sign : {-1, 1}) its.say(PatchId{1}, PatchId{4}, {sign * off_m, 0, 0});
    const Trial trial = its.tried();
    EXPECT_EQ(trial.refusal(), off_m == 0 ? Reason::none : Reason::sightings_disagree);
    EXPECT_EQ(trial.accepted(), off_m == 0);
  }
}

// As those do of a robot whose clock is late: more than their noise tells, far less than what is false.
TEST(TrialBySightings, ThatPullALittleAreAcceptedWhereManySayTheSame) {
  for (const auto& [supporters, off_m] : {std::pair{3, 0.06}, {20, 0.06}, {20, 1.0}}) {
    Case its = merge_of(crooked_room(), outward, crooked_room(), homeward);
    for (const double sign : {-1, 1}) its.say(PatchId{1}, PatchId{4}, {sign * off_m, 0, 0});
    its.proposal.supporters = supporters;
    const Trial trial = its.tried();
    EXPECT_GT(trial.account().cost, TrialOptions{}.even_sighting_cost);
    EXPECT_LT(trial.account().fit_log_odds, 0);
    EXPECT_EQ(trial.accepted(), supporters == 20 && off_m < 1) << supporters << ' ' << off_m;
  }
}

TEST(TrialBySightings, ThatPutsWallsInFreeSpaceIsRefused) {
  for (const bool contradicts : {false, true}) {
    const Walls room = crooked_room();
    Case its =
        merge_of(room, {{-1.5, -0.4, 0.2}}, contradicts ? with_a_screen(room) : room, {{-1.4, -0.3, 0.4}});
    its.say(PatchId{0}, PatchId{1});
    const Trial trial = its.tried();
    EXPECT_EQ(trial.refusal(), contradicts ? Reason::walls_in_free_space : Reason::none);
    EXPECT_EQ(trial.accepted(), !contradicts);
  }
}

// Thirty that agree are not all wrong, whatever a door or a screen does.
TEST(TrialBySightings, OfManyThatAgreeOutweighsWallsInFreeSpace) {
  Case its =
      merge_of(crooked_room(), {{-1.5, -0.4, 0.2}}, with_a_screen(crooked_room()), {{-1.4, -0.3, 0.4}});
  its.say(PatchId{0}, PatchId{1});
  its.proposal.supporters = 30;
  const Trial trial = its.tried();
  EXPECT_TRUE(trial.accepted()) << word(trial.refusal());
  EXPECT_LT(trial.account().fit_log_odds, -1) << "it is told all the same";
}

/// A loop on an island that is sure of something wrong: a relation as narrow as any other has the second way
/// two metres and a right angle from where it truly is.
Case loop_across_a_slip(int supporters) {
  Case made = loop_of(crooked_room(), outward, crooked_room(), homeward);
  const PatchId a = made.first.back(), b = made.second.front();
  const Pose slip{2, 0.3, 1.6};
  made.map.remove(made.map.graph().between(a, b));
  const Pose of_b = made.map.manifold().pose(b);
  const Pose wrong = made.map.manifold().pose(a) * made.true_relative(a, b) * slip;
  made.map.move_island(b, wrong * inverse(of_b));
  Relation sure = sighting_tie(a, b, made.true_relative(a, b) * slip);
  sure.origin = {OriginKind::odometry, {}};
  made.map.relate(sure);
  made.say(PatchId{1}, PatchId{4});
  made.proposal.supporters = supporters;
  made.proposal.older_from_younger = made.truth(b) * inverse(wrong);
  made.proposal.loop = {{PatchId{1}}, {PatchId{4}}, made.truth(b) * inverse(wrong), 5};
  return made;
}

TEST(TrialBySightings, OfManyThatAgreeBlamesTheLinkThatTheMapWasSureOf) {
  Case its = loop_across_a_slip(12);
  const Trial trial = its.tried();
  EXPECT_TRUE(trial.accepted()) << word(trial.refusal());
  ASSERT_EQ(trial.blamed().size(), 1U);
  const RelationId wrong = trial.blamed().front();
  EXPECT_GE(trial.account().blamed_log_odds, WeakLinkOptions{}.odometry_log_odds);
  trial.commit(its.map);
  EXPECT_EQ(its.map.graph().find(wrong), nullptr);
  const Pose mapped = its.map.relative_pose(PatchId{0}, PatchId{5});
  EXPECT_NEAR(mapped.x, its.true_relative(PatchId{0}, PatchId{5}).x, 0.05);
  EXPECT_NEAR(mapped.y, its.true_relative(PatchId{0}, PatchId{5}).y, 0.05);
}

// Three agree by chance now and then, oftener than a link is wrong that the map is so sure of.
TEST(TrialBySightings, OfFewThatAgreeBlamesNothingThatTheMapIsSureOf) {
  Case its = loop_across_a_slip(3);
  EngineOptions options;
  options.weak_links.odometry_log_odds = 20;
  const Trial trial = its.tried(options);
  EXPECT_FALSE(trial.accepted());
  EXPECT_EQ(trial.refusal(), Reason::sightings_disagree);
}

// Somebody who came and went while the first robot was there: its own map contradicts itself as much.
TEST(TrialBySightings, MayContradictAsMuchAsTheMapsContradictThemselves) {
  const Walls without = crooked_room(), with = with_a_screen(without);
  Case its = merge_of(
      std::vector{with, without, with}, {{-1.5, -0.4, 0.2}, {-1.6, -0.3, 0.1}, {-1.7, -0.5, 0}},
      std::vector{without, with, without}, {{-1.4, -0.3, 0.2}, {-1.5, -0.5, 0.1}, {-1.6, -0.4, 0.3}});
  its.say(PatchId{1}, PatchId{4});
  const Trial trial = its.tried();
  EXPECT_TRUE(trial.accepted()) << word(trial.refusal());
}

TEST(TrialBySightings, WhoseScansDoNotMatchIsRefused) {
  Walls plain;
  add_box(plain, -4, -3, 4, 3);
  for (const bool matches : {true, false}) {
    Case its = merge_of(plain, outward, matches ? plain : toothed_room(), homeward);
    its.say(PatchId{1}, PatchId{4});
    const Trial trial = its.tried();
    EXPECT_EQ(trial.refusal(), matches ? Reason::none : Reason::scans_disagree);
    EXPECT_EQ(trial.accepted(), matches);
  }
}

// Nothing to compare: sightings must say it alone, and then they must be enough.
TEST(TrialBySightings, WithoutScansNeedsMoreSupportFromOneDirectionThanFromTwo) {
  Walls none;
  for (const auto& [supporters, two_way, enough] :
       {std::tuple{3, true, false}, {4, true, true}, {5, false, false}, {6, false, true}}) {
    Case its = merge_of(none, outward, none, homeward);
    its.say(PatchId{1}, PatchId{4});
    its.proposal.supporters = supporters;
    its.proposal.two_way = two_way;
    const Trial trial = its.tried();
    EXPECT_EQ(trial.accepted(), enough) << supporters;
    EXPECT_EQ(trial.undecided(), !enough) << supporters;
  }
}

// A metre to the side in a chain good to some centimetres, and nothing else to judge it by.
TEST(TrialBySightings, ThatBendsALoopBeyondItsCovarianceIsRefusedUnlessManySayIt) {
  const Walls none;
  for (const auto& [off_m, supporters, refusal] :
       {std::tuple{0.2, 4, Reason::none}, {1.5, 4, Reason::implausible_jump}, {1.5, 6, Reason::none}}) {
    Case its;
    its.add(none, {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}, true, {});
    its.proposal.older = its.proposal.younger = PatchId{0};
    its.proposal.supporters = supporters;
    its.proposal.two_way = true;
    its.say(PatchId{0}, PatchId{3}, {0, off_m, 0}, 3e-5, 1);
    const Trial trial = its.tried();
    EXPECT_EQ(trial.refusal(), refusal) << off_m << " by " << supporters;
    EXPECT_EQ(trial.accepted(), refusal == Reason::none);
  }
}

}  // namespace
}  // namespace isthmus
