// Teams that find one another: by one camera alone, by tags, after long laps in opposite directions, and
// though three sightings in ten are false.

#include "tests/scenario/event_sequences.hpp"
#include "tools/simulate/campaigns/sightings/sightings.hpp"

namespace isthmus {
namespace {

double inter_error_m(const SimulatedMap& simulated) {
  std::vector<ScanRelation> relations = sample_relations(simulated.run.truth, 1);
  std::erase_if(relations, [](const ScanRelation& r) { return r.robot1 == r.robot2; });
  const RelationComparison error = compare(relations, simulated.map, simulated.map);
  EXPECT_GT(error.compared, 30U);
  EXPECT_EQ(error.missing, 0U);
  return error.mean_m;
}

TEST(SimulatedTeams, OneCameraIsEnoughToMergeTwoRobots) {
  const SimulatedMap one_way = map_scenario("one_way");
  for (const SightingRecord& record : one_way.map.sightings) EXPECT_EQ(record.sighting.robot, "R1");
  EXPECT_EQ(islands(one_way.map), 1U);
  EXPECT_EQ(state_of(one_way.map, 0), "accepted");
  EXPECT_EQ(closure_of(one_way.map, 0).kind, ClosureKind::merge);
  EXPECT_GE(judge_sightings(one_way.run, one_way.map.sightings).true_share(), 0.95);
  EXPECT_LT(inter_error_m(one_way), 0.05);
  EXPECT_LT(judge_trajectories(one_way).mean_m, 0.03);
}

TEST(SimulatedTeams, TagsAreMappedAndJoinTheTeam) {
  const SimulatedMap tags = map_scenario("tags");
  EXPECT_EQ(islands(tags.map), 1U);
  ASSERT_EQ(tags.map.tags.size(), 6U);
  for (const TagRecord& tag : tags.map.tags) EXPECT_TRUE(tag.placed) << tag.barcode;
  EXPECT_GE(judge_sightings(tags.run, tags.map.sightings).true_share(), 0.95);
  EXPECT_LT(inter_error_m(tags), 0.05);

  // Distances between tags are free of frames.
  const std::vector<TagPlan>& truth = load_scenario("tags").tags;
  double sum_m = 0;
  int pairs = 0;
  for (std::size_t i = 0; i < truth.size(); ++i)
    for (std::size_t j = 0; j < i; ++j, ++pairs) {
      const double true_m = (truth[i].position - truth[j].position).norm();
      ASSERT_EQ(tags.map.tags[i].barcode, truth[i].barcode);
      const double mapped_m = (tags.map.tags[i].position - tags.map.tags[j].position).norm();
      EXPECT_NEAR(mapped_m, true_m, 0.3) << truth[i].barcode << " and " << truth[j].barcode;
      sum_m += std::abs(mapped_m - true_m);
    }
  std::printf("tags: distances between them off by %.3f m on average\n", sum_m / pairs);
  EXPECT_LT(sum_m / pairs, 0.1);
}

/// When the first sighting of a run was.
std::int64_t first_sighting_utime(const MapCopy& map) {
  std::int64_t first = std::numeric_limits<std::int64_t>::max();
  for (const SightingRecord& record : map.sightings) first = std::min(first, record.sighting.utime);
  return first;
}

// The paper's double spiral: laps in opposite directions, then the first meeting. R2 comes where R1 has been
// everywhere (late_spiral.toml); for once, scans alone join no two maps of the same whole.
TEST(SimulatedTeams, OneMeetingCollapsesADoubleSpiral) {
  Configuration by_meeting;
  by_meeting.engine.trial.min_whole_log_odds = 1e9;
  SimulatedMap spiral{simulate(load_scenario("late_spiral"), 1), {}};
  spiral.map = map_events(spiral.run.events, by_meeting);
  const std::int64_t met_utime = first_sighting_utime(spiral.map);
  Played alone = play(spiral.run.events, met_utime, by_meeting);
  EXPECT_EQ(islands(alone.engine.copy()), 2U) << "nothing but the meeting joins them";

  EXPECT_EQ(islands(spiral.map), 1U);
  const auto merge = std::ranges::find_if(spiral.map.closures, [](const ClosureRecord& closure) {
    return closure.kind == ClosureKind::merge && closure.state == ClosureState::accepted;
  });
  ASSERT_NE(merge, spiral.map.closures.end());
  EXPECT_NE(merge->reason, Reason::from_scans);
  EXPECT_GE(merge->start_utime, met_utime);
  EXPECT_GT(merge->patches_touched, 100) << "all along the laps there are by then";
  int by_sightings = 0;
  for (const SightingRecord& record : spiral.map.sightings)
    by_sightings += record.reason == Reason::merged_islands && record.closure == merge->id ? 1 : 0;
  EXPECT_GE(by_sightings, 3);
  EXPECT_GE(judge_sightings(spiral.run, spiral.map.sightings).true_share(), 0.95);
  const TrajectoryError error = judge_trajectories(spiral);
  std::printf("double spiral: %zu patches, %d touched; intra mean %.4f m, at most %.3f m\n",
              spiral.map.patches.size(), merge->patches_touched, error.mean_m, error.max_m);
  EXPECT_LT(error.mean_m, 0.012);
  EXPECT_LT(error.max_m, 0.2);
  EXPECT_LT(inter_error_m(spiral), 0.03);
}

// The laps are of one hall, too large to look like another: scans join them before anybody meets.
TEST(SimulatedTeams, ScansCollapseADoubleSpiralOfTheSameWhole) {
  const SimulatedMap spiral = map_scenario("late_spiral");
  EXPECT_EQ(islands(spiral.map), 1U);
  const auto merge = std::ranges::find(spiral.map.closures, ClosureState::accepted, &ClosureRecord::state);
  ASSERT_NE(merge, spiral.map.closures.end());
  EXPECT_EQ(merge->reason, Reason::from_scans);
  EXPECT_LT(merge->end_utime, first_sighting_utime(spiral.map));
  EXPECT_LT(judge_trajectories(spiral).mean_m, 0.012);
  EXPECT_LT(inter_error_m(spiral), 0.03);
}

// Odometry, barcodes on the walls, and one another: no robot has a laser.
TEST(SimulatedTeams, RobotsWithoutALaserAreMappedByWhatTheySee) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const SimulatedMap blind = map_scenario("blind", {}, seed);
    EXPECT_EQ(blind.map.counters.scans, 0);
    EXPECT_EQ(islands(blind.map), 1U) << seed;
    ASSERT_EQ(blind.map.tags.size(), 12U);
    for (const TagRecord& tag : blind.map.tags) EXPECT_TRUE(tag.placed) << tag.barcode;
    EXPECT_GE(judge_sightings(blind.run, blind.map.sightings).true_share(), 0.95);
    const TrajectoryError error = judge_trajectories(blind);
    const double inter_m = inter_error_m(blind);
    std::printf("blind, seed %lu: intra %.4f m and %.4f rad, at most %.3f m; inter %.4f m\n", seed,
                error.mean_m, error.mean_rad, error.max_m, inter_m);
    EXPECT_GT(error.relations, 500U);
    EXPECT_EQ(error.missing, 0U);
    EXPECT_LT(error.mean_m, 0.05);
    EXPECT_LT(error.mean_rad, 0.02);
    EXPECT_LT(error.max_m, 0.6);
    EXPECT_LT(inter_m, 0.09);
  }
}

class FalseSightings : public testing::TestWithParam<std::uint64_t> {};

TEST_P(FalseSightings, ThreeInTenAreAllRefusedAndTheTrueOnesUsed) {
  const SimulatedMap spoilt = map_scenario("meeting", {"false_sightings=0.3"}, GetParam());
  const SightingScore score = judge_sightings(spoilt.run, spoilt.map.sightings);
  EXPECT_GT(score.false_ones, 20U);
  EXPECT_EQ(score.false_accepted, 0U);
  EXPECT_GE(score.true_share(), 0.95);
  EXPECT_EQ(islands(spoilt.map), 1U);
  for (const SightingRecord& record : spoilt.map.sightings)
    if (record.verdict == Verdict::refused) {
      EXPECT_NE(record.reason, Reason::none);
    }
  std::printf("seed %lu: %zu of %zu true accepted, %zu of %zu false; intra %.4f m, inter %.4f m\n",
              GetParam(), score.true_accepted, score.true_ones, score.false_accepted, score.false_ones,
              judge_trajectories(spoilt).mean_m, inter_error_m(spoilt));
  EXPECT_LT(inter_error_m(spoilt), 0.25);
}

INSTANTIATE_TEST_SUITE_P(Seeds, FalseSightings, testing::Values(1, 2, 3));

}  // namespace
}  // namespace isthmus
