// What the defaults of each room must hold to for its code to make sense, whatever their values are.

#include <gtest/gtest.h>

#include <cmath>

#include "server/engine/input/engine_options.hpp"
#include "server/engine/input/options/closure_options.hpp"
#include "server/engine/input/options/common_options.hpp"
#include "server/engine/input/options/frozen_options.hpp"
#include "server/engine/input/options/hypothesis_options.hpp"
#include "server/engine/input/options/intake_options.hpp"
#include "server/engine/input/options/localise_options.hpp"
#include "server/engine/input/options/map_options.hpp"
#include "server/engine/input/options/place_options.hpp"
#include "server/engine/input/options/propagation_options.hpp"
#include "server/engine/input/options/record_options.hpp"
#include "server/engine/input/options/rendezvous_options.hpp"
#include "server/engine/input/options/robot_options.hpp"
#include "server/engine/input/options/sighting_options.hpp"

namespace isthmus {
namespace {

TEST(EngineOptions, LeaveALocalMapPatchesToMatchWith) {
  const EngineOptions options;
  EXPECT_LT(options.patch_spacing_m, options.surroundings.reach_m)
      << "a robot that drove on to its next patch still matches with the last";
  EXPECT_LT(options.match.kernel_m, options.match.start_kernel_m);
}

TEST(LocaliseOptions, AskMoreOfAMatchTheLessItWasExpected) {
  const LocaliseOptions its;
  EXPECT_LT(its.min_score, its.common.doubtful_score);
  EXPECT_LT(its.common.doubtful_score, its.common.sure_score);
  EXPECT_LT(its.weighed_surprise.probability(), its.common.surprise.probability());
}

TEST(LocaliseOptions, SearchWindowsThatAreNotEmpty) {
  const LocaliseOptions its;
  EXPECT_LT(its.min_window_m, its.max_window_m);
  EXPECT_LT(its.min_window_rad, its.max_window_rad);
}

TEST(ExtendOptions, AskLessOfAMatchOnNewGroundThanOfOneThatIsTurnedAway) {
  const ExtendOptions its;
  EXPECT_LT(its.thin_score, its.turned_score);
}

TEST(SurroundingsOptions, LookFartherForLoopsThanForAMatch) {
  const SurroundingsOptions its;
  EXPECT_GT(its.loop_patches, its.confidence_patches);
  EXPECT_GT(its.loop_position_m, its.reach_m);
}

TEST(LocalLoopOptions, TakeAWindowForUnambiguousThatIsNarrowerThanTheWidest) {
  const LocalLoopOptions its;
  EXPECT_LT(its.unambiguous_half_width_m, its.max_window_m);
  EXPECT_LT(its.min_paired, its.common.sure_score)
      << "what finds something to pair with must fit, more than it must be paired";
}

TEST(PlaceCandidateOptions, TakeForSystematicAPartOfWhatAWayMayErrBy) {
  const PlaceCandidateOptions its;
  EXPECT_LT(its.systematic_share, its.drift_per_way) << "of what a way may err by, a part is systematic";
}

TEST(PlaceSearchOptions, FindCoarselyWhatIsThenSearchedFinely) { EXPECT_GT(PlaceSearchOptions{}.coarse, 1); }

TEST(FindEvidenceOptions, LetWaitWhatFitsWellAndNotWhatFitsJustWellEnoughToBeLookedAt) {
  const EngineOptions its;
  const FindEvidenceOptions& odds = its.find_evidence;
  const auto log_odds = [&](double search_score, double carrier_score, double seen_again) {
    return odds.per_search_score * search_score + odds.per_carrier_score * carrier_score +
           odds.per_seen_again * seen_again - odds.against_no_score;
  };
  const double waits =
      std::log(its.hypotheses.min_find_probability / (1 - its.hypotheses.min_find_probability));
  EXPECT_LT(log_odds(its.hypotheses.min_score, its.common.doubtful_score, 0.5), waits);
  EXPECT_GT(log_odds(0.6, 0.6, 0.95), 0) << "as most true ones do";
  EXPECT_GT(its.finder.min_find_probability, its.hypotheses.min_find_probability)
      << "a robot is put there at once";
}

TEST(TrialOptions, AskMoreSightingsOfOneDirectionThanOfBoth) {
  const TrialOptions its;
  EXPECT_LT(its.min_support_two_way, its.common.overruling);
  EXPECT_GT(its.few_matched_scans, its.common.agreeing) << "scans alone must prove more";
  EXPECT_LT(its.min_loop_log_odds, its.min_whole_log_odds) << "a merge of wholes is bolder than a loop";
}

TEST(PropagationOptions, CostNoMoreAStepThanCanBeSavedUp) {
  const EngineOptions its;
  EXPECT_GE(its.common.max_credit_us, its.propagation.step_price_us) << "else no step would ever be taken";
}

TEST(ClosureOptions, TryAGroupAgainOnlyOnceItHasGrown) {
  const ClosureOptions its;
  EXPECT_GT(its.retry_growth, 1);
  EXPECT_LE(its.max_compared, its.max_waiting);
}

TEST(HypothesisOptions, AskMoreOfAPlaceThatIsSearchedForAnywhere) {
  const HypothesisOptions its;
  EXPECT_LT(its.min_score, CommonOptions{}.sure_score);
  EXPECT_LT(its.query_every_m, its.max_piece_way_m) << "pieces overlap, so that no place is passed over";
  EXPECT_LT(its.min_piece_way_m, its.max_piece_way_m);
}

TEST(CommonOptions, LetAsManyFindsWaitAsMustAgree) {
  const CommonOptions its;
  EXPECT_LT(static_cast<std::size_t>(its.agreeing), its.max_finds);
  EXPECT_GT(its.overruling, its.agreeing);
  EXPECT_LT(its.agreeing_m, its.apart_m) << "what agrees is no other place";
}

TEST(FrozenOptions, GiveARobotUpOnlyAfterDoubt) {
  const FrozenOptions its;
  EXPECT_LT(its.doubted_m, its.given_up_m);
}

TEST(IntakeOptions, WaitForOdometryNoLongerThanStampsMayRunBackwards) {
  const IntakeOptions its;
  EXPECT_LE(its.odometry_wait_us, its.backward_us);
}

TEST(OdometryNoiseOptions, BeginWithinWhatIsLearned) {
  const OdometryNoiseOptions its;
  EXPECT_GT(its.first_scale, its.min_scale);
  EXPECT_LT(its.first_scale, its.max_scale);
  EXPECT_GT(its.first_path_scale, its.min_path_scale);
}

TEST(PoseHistoryOptions, KeepPosesOftenerThanTheyAreThinnedTo) {
  const PoseHistoryOptions its;
  EXPECT_LT(its.near_us, its.newest_us);
}

TEST(TeammateOptions, ForgetWhatWasSeenBeforeWhatWasPlaced) {
  const TeammateOptions its;
  EXPECT_LT(its.seen_us, its.placed_us);
}

TEST(HealthWarningOptions, TakeAnotherUnitForFartherOffThanAnotherScale) {
  const HealthWarningOptions its;
  EXPECT_LT(its.other_scale, its.other_unit);
  EXPECT_GT(its.backwards_rad, its.other_direction_rad);
}

TEST(AlignmentOptions, AskMoreOfSightingsOfOneDirection) {
  const AlignmentOptions its;
  EXPECT_LT(its.min_baseline_m, its.common.baseline_m);
  EXPECT_LT(its.lone_pair_us, its.rival_us);
}

TEST(EvidenceOptions, PlaceATagByMoreThanAPairOfSightings) {
  const EvidenceOptions its;
  EXPECT_GT(its.common.agreeing, 2) << "two are asked to be from places apart";
  EXPECT_GT(its.min_apart_m, 0);
}

TEST(MeetingOptions, TryDistancesOnBothSidesOfTheBest) {
  const MeetingOptions its;
  EXPECT_GT(its.search_m, its.distance_m + its.distance_step_m);
}

TEST(RendezvousOptions, HoldRobotsForNearOnlyWhereTheyAreToMeet) {
  const RendezvousOptions its;
  EXPECT_LT(its.in_place_m, MeetingOptions{}.distance_m - MeetingOptions{}.distance_step_m);
  EXPECT_LT(its.max_gap_us, its.watch_us) << "a gap that ends watching is no part of it";
}

TEST(RefinementOptions, HoldAScanWhereItWasCarriedMoreLooselyThanAPointHoldsIt) {
  EXPECT_GT(RefinementOptions{}.carried_sigma_m, MatchOptions{}.sigma_m) << "else no match could move it";
}

}  // namespace
}  // namespace isthmus
