// Buildings of which one place looks like another: no relation may say that they are one.

#include "tools/simulate/campaigns/sightings/closures.hpp"

#include "tests/scenario/simulated_maps.hpp"
#include "tools/simulate/campaigns/sightings/sightings.hpp"

namespace isthmus {
namespace {

/// A run's map and what its closures are worth.
struct Judged {
  SimulatedMap simulated;
  ClosureScore score;
  std::size_t accepted = 0;   ///< closures of the record
  std::size_t came_back = 0;  ///< relations between patches made over half a minute apart
  double mean_error_m = 0;
};

Judged judged(const std::string& scenario, std::uint64_t seed) {
  constexpr std::int64_t apart_us = 30'000'000;
  Judged result{map_scenario(scenario, {}, seed), {}, 0, 0, 0};
  const MapCopy& map = result.simulated.map;
  result.score = judge_closures(map, result.simulated.run.truth);
  result.accepted = static_cast<std::size_t>(
      std::ranges::count(map.closures, ClosureState::accepted, &ClosureRecord::state));
  for (const auto& [id, relation] : map.graph.relations()) {
    const auto utime = [&](PatchId patch) {
      return map.patches[static_cast<std::size_t>(patch.value)]->utime;
    };
    if (std::abs(utime(relation.a) - utime(relation.b)) > apart_us) ++result.came_back;
  }
  const RelationComparison error = compare(sample_relations(result.simulated.run.truth, 1), map, map);
  result.mean_error_m = error.mean_m;
  EXPECT_GT(error.compared, 100U);
  std::printf("%s, seed %lu: %zu islands, %zu closures, %zu relations of which %zu came back, error %.4f m\n",
              scenario.c_str(), seed, result.score.islands, result.accepted, result.score.relations,
              result.came_back, error.mean_m);
  return result;
}

/// What is asked of every run, its figures as measured and half as much again.
struct Asked {
  std::size_t islands = 1;
  std::size_t closures = 0;   ///< at least so many accepted
  std::size_t came_back = 0;  ///< at least so many relations with where a robot had been before
  double mean_error_m = 0;
};

void expect_no_wrong_closures(const std::string& scenario, const Asked& asked) {
  for (const std::uint64_t seed : {1U, 2U}) {
    const Judged run = judged(scenario, seed);
    EXPECT_EQ(run.score.wrong_closures, 0U) << scenario << " " << seed;
    EXPECT_EQ(run.score.wrong_merges, 0U) << scenario << " " << seed;
    EXPECT_EQ(run.score.islands, asked.islands) << scenario << " " << seed;
    EXPECT_GE(run.accepted, asked.closures) << scenario << " " << seed;
    EXPECT_GE(run.came_back, asked.came_back) << scenario << " " << seed;
    EXPECT_LT(run.mean_error_m, asked.mean_error_m) << scenario << " " << seed;
  }
}

// The robot comes back to four of twelve rooms: it must know them again, and not take one for another.
TEST(ClosuresCampaign, IdenticalRooms) { expect_no_wrong_closures("repeated_rooms", {1, 0, 100, 0.11}); }

TEST(ClosuresCampaign, ParallelCorridors) { expect_no_wrong_closures("long_corridors", {1, 0, 36, 0.42}); }

TEST(ClosuresCampaign, OneRobotInTwoWingsOfOnePlan) {
  expect_no_wrong_closures("two_wings", {1, 0, 150, 0.03});
}

TEST(ClosuresCampaign, TwoRobotsThatMeetInTwoWingsOfOnePlan) {
  expect_no_wrong_closures("two_wings_pair", {1, 1, 50, 0.035});
}

// Nothing says how the two wings lie to one another: the maps stay apart.
TEST(ClosuresCampaign, TwoRobotsInTwoWingsThatNothingJoins) {
  expect_no_wrong_closures("two_wings_apart", {2, 0, 50, 0.025});
}

}  // namespace
}  // namespace isthmus
