// What the defaults of each room must hold to for its code to make sense, whatever their values are.

#include <gtest/gtest.h>

#include <cmath>

#include "server/engine/input/engine_options.hpp"
#include "server/engine/input/options/closure_options.hpp"
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
  EXPECT_LT(its.min_score, its.doubtful_score);
  EXPECT_LT(its.doubtful_score, its.min_score_implausible);
  EXPECT_LT(its.weighed_surprise.value(), its.doubted_surprise.value());
}

TEST(LocaliseOptions, SearchWindowsThatAreNotEmpty) {
  const LocaliseOptions its;
  EXPECT_LT(its.min_window_m, its.max_window_m);
  EXPECT_LT(its.min_window_rad, its.max_window_rad);
}

TEST(ExtendOptions, LookAtABeamFromNearToFar) {
  const ExtendOptions its;
  EXPECT_LT(its.first_sample, its.second_sample);
  EXPECT_LT(its.second_sample, its.third_sample);
  EXPECT_LT(its.third_sample, 1) << "a hit is no free space";
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
  EXPECT_LT(its.min_paired, its.min_score_partly_known)
      << "what finds something to pair with must fit, more than it must be paired";
}

TEST(PlaceCandidateOptions, LeaveNoGapBetweenTheWindowsOfPlaces) {
  const PlaceCandidateOptions its;
  EXPECT_LE(its.spacing_m, 2 * its.half_window_m);
  EXPECT_LT(its.systematic_share, its.drift_per_way) << "of what a way may err by, a part is systematic";
}

TEST(PlaceSearchOptions, FindCoarselyWhatIsThenSearchedFinely) {
  const PlaceSearchOptions its;
  EXPECT_GE(its.fine_window_m, its.coarse_cell_m);
  EXPECT_GE(its.fine_window_rad, its.coarse_yaw_step_rad);
}

TEST(FindEvidenceOptions, LetWaitWhatFitsWellAndNotWhatFitsJustWellEnoughToBeLookedAt) {
  const EngineOptions its;
  const FindEvidenceOptions& odds = its.find_evidence;
  const auto log_odds = [&](double search_score, double carrier_score) {
    return odds.per_search_score * search_score + odds.per_carrier_score * carrier_score -
           odds.against_no_score;
  };
  const double waits =
      std::log(its.hypotheses.min_find_probability / (1 - its.hypotheses.min_find_probability));
  EXPECT_LT(log_odds(its.hypotheses.min_score, its.place_search.min_score), waits);
  EXPECT_GT(log_odds(0.7, 0.8), its.hypotheses.min_log_odds) << "as most true ones do";
  EXPECT_GT(its.finder.min_find_probability, its.hypotheses.min_find_probability)
      << "a robot is put there at once";
}

TEST(TrialOptions, AskMoreSightingsOfOneDirectionThanOfBoth) {
  const TrialOptions its;
  EXPECT_LT(its.min_support_two_way, its.min_support_one_way);
  EXPECT_GE(its.strong_support, its.min_support_one_way);
  EXPECT_GT(its.few_matched_scans, its.few_compared) << "scans alone must prove more";
  EXPECT_LT(its.min_loop_log_odds, its.min_whole_log_odds) << "a merge of wholes is bolder than a loop";
}

TEST(PropagationOptions, CostNoMoreAStepThanCanBeSavedUp) {
  const EngineOptions its;
  const char* else_what = "else no step would ever be taken";
  EXPECT_GE(its.proximity_matching.max_credit_us, its.propagation.step_price_us) << else_what;
  EXPECT_GE(its.closures.max_credit_us, its.propagation.step_price_us) << else_what;
}

TEST(ClosureOptions, TryAGroupAgainOnlyOnceItHasGrown) {
  const ClosureOptions its;
  EXPECT_GT(its.retry_growth, 1);
  EXPECT_LE(its.max_compared, its.max_waiting);
}

TEST(HypothesisOptions, AskMoreOfAPlaceThatIsSearchedForAnywhere) {
  const HypothesisOptions its;
  EXPECT_LT(its.min_score, its.min_score_anywhere);
  EXPECT_LT(its.query_every_m, its.max_piece_way_m) << "pieces overlap, so that no place is passed over";
  EXPECT_LT(its.min_piece_way_m, its.max_piece_way_m);
  EXPECT_LE(its.min_merge_finds, its.max_finds);
}

TEST(FinderOptions, SearchForPiecesOfMoreThanTheLeastWay) {
  const FinderOptions its;
  EXPECT_LT(its.min_piece_way_m, its.max_piece_way_m);
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
  EXPECT_LT(its.spacing_us, its.newest_us);
}

TEST(TeammateOptions, ForgetWhatWasSeenBeforeWhatWasPlaced) {
  const TeammateOptions its;
  EXPECT_LT(its.seen_us, its.placed_us);
}

TEST(HealthWarningOptions, TakeAnotherUnitForFartherOffThanAnotherScale) {
  const HealthWarningOptions its;
  EXPECT_LT(its.other_scale, its.other_unit);
  EXPECT_LT(its.near_unit, its.other_scale);
  EXPECT_GT(its.backwards_rad, its.other_direction_rad);
}

TEST(AlignmentOptions, AskMoreOfSightingsOfOneDirection) {
  const AlignmentOptions its;
  EXPECT_LT(its.min_baseline_m, its.one_way_baseline_m);
  EXPECT_LT(its.lone_pair_us, its.rival_us);
}

TEST(EvidenceOptions, PlaceATagByMoreThanAPairOfSightings) {
  const EvidenceOptions its;
  EXPECT_GT(its.min_supporters, 2U) << "two are asked to be from places apart";
  EXPECT_GT(its.min_apart_m, 0);
}

TEST(MeetingOptions, TryDistancesOnBothSidesOfTheBest) {
  const MeetingOptions its;
  EXPECT_LT(its.shorter_distance_m, its.distance_m);
  EXPECT_LT(its.distance_m, its.longer_distance_m);
  EXPECT_GT(its.search_m, its.longer_distance_m);
}

TEST(RendezvousOptions, HoldRobotsForNearOnlyWhereTheyAreToMeet) {
  const RendezvousOptions its;
  EXPECT_LT(its.in_place_m, MeetingOptions{}.shorter_distance_m);
  EXPECT_LT(its.max_gap_us, its.watch_us) << "a gap that ends watching is no part of it";
}

TEST(RefinementOptions, MatchFromNearerThanTheFirstTime) {
  const RefinementOptions its;
  EXPECT_LE(its.start_kernel_m, MatchOptions{}.start_kernel_m) << "what is refined has been matched";
}

}  // namespace
}  // namespace isthmus
